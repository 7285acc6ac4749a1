#include "vulkan/device/kernel.glsl"
#include "number_invocations.h"

layout(constant_id = 1) const uint kFirst = 0;
layout(push_constant, scalar) uniform Push { NumberInvocationsPush push; };

void main() {
  const uint index = push.firstGroup * gl_WorkGroupSize.x + invocationIndex();
  if (index < push.count && push.groupSize == gl_WorkGroupSize.x) push.groups.at[index] = kFirst + push.firstGroup + groupIndex();
}
