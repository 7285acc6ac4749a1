#include "vulkan/device/kernel.glsl"
#include "counted_loops.h"

layout(push_constant, scalar) uniform Push { CountedLoopsPush push; };

void main() {
  const uint index = invocationIndex();
  Vec4s(push.sums).at[index] = 2.0 * Vec4s(push.values).at[index];
}
