// Computes the numbers of groups of the dispatches over a number of items that only the device knows.
#include "vulkan/device/kernel.glsl"
#include "vulkan/primitives/dispatch_arguments_push.h"

layout(push_constant, scalar) uniform Push { DispatchArgumentsPush push; };

void main() {
  const uint part = invocationIndex();
  if (part >= push.parts) return;
  const uint all = ceilDiv(min(push.count.at[0], push.most), push.itemsPerGroup);
  const uint groups = min(all - min(all, part * push.mostGroups), push.mostGroups);
  const uint y = max(ceilDiv(groups, kMaxGroups), 1);
  push.entries.at[3 * part] = ceilDiv(groups, y);
  push.entries.at[3 * part + 1] = y;
  push.entries.at[3 * part + 2] = 1;
}
