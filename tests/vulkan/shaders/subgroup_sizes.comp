// Each invocation counts the invocations of its subgroup. It does not read gl_SubgroupSize, which would be a constant
// that distinguishes the kernels of different sizes in a driver's cache.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "subgroup_sizes.h"

layout(push_constant, scalar) uniform Push { SubgroupSizesPush push; };

void main() {
  push.sizes.at[gl_LocalInvocationIndex] = subgroupAdd(1);
}
