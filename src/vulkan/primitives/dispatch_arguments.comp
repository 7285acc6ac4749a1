// Computes the number of groups to dispatch over a number of items that only the device knows.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/primitives/dispatch_arguments_push.h"

layout(push_constant, scalar) uniform Push { DispatchArgumentsPush push; };

void main() {
  const uint part = invocationIndex();
  if (part >= push.parts) return;
  const uint count = readCount(push.count, push.most);
  const uint all = max(ceilDiv(count, push.itemsPerGroup), push.fewestGroups);
  const uint groups = min(all - min(all, part * push.mostGroups), push.mostGroups);
  const uint y = max(ceilDiv(groups, kMaxGroups), 1);
  push.entry.at[4 * part] = ceilDiv(groups, y);
  push.entry.at[4 * part + 1] = y;
  push.entry.at[4 * part + 2] = 1;
  push.entry.at[4 * part + 3] = all * push.scale;
}
