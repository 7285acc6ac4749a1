// Computes the numbers of groups of dispatches, from a number that only the device knows.
#include "vulkan/device/kernel.glsl"
#include "vulkan/primitives/dispatch_arguments_push.h"

layout(push_constant, scalar) uniform Push { DispatchArgumentsPush push; };

uint groupsOf(uint part, uint number) {
  if (uint64_t(push.planned) != 0) return number == 0 ? 0 : push.planned.at[part];
  const uint all = ceilDiv(min(number, push.most), push.itemsPerGroup);
  return min(all - min(all, part * push.mostGroups), push.mostGroups);
}

void main() {
  const uint part = invocationIndex();
  if (part >= push.parts) return;
  const uint groups = groupsOf(part, push.number.at[0]), y = max(ceilDiv(groups, kMaxGroups), 1);
  push.entries.at[3 * part] = ceilDiv(groups, y);
  push.entries.at[3 * part + 1] = y;
  push.entries.at[3 * part + 2] = 1;
}
