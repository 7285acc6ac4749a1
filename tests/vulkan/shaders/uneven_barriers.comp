// Each subgroup waits for its own lanes as often as its number says. A driver that takes these waits for barriers
// of the whole group stops some subgroups for ever.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "uneven_barriers.h"

layout(push_constant, scalar) uniform Push { UnevenBarriersPush push; };

void main() {
  for (uint i = 0; i < gl_SubgroupID; ++i) subgroupBarrier();
  if (subgroupElect()) push.reached.at[gl_SubgroupID] = 1;
}
