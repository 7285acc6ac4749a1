#include "vulkan/device/kernel.glsl"
#include "count_runs.h"

layout(push_constant, scalar) uniform Push { CountRunsPush push; };

void main() {
  const uint group = push.firstGroup + groupIndex();
  if (group < push.count) atomicAdd(push.runs.at[group], 1);
}
