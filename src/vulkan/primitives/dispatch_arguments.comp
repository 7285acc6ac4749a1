// Computes the number of groups to dispatch over a number of items that only the device knows.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/primitives/dispatch_arguments_push.h"

layout(push_constant, scalar) uniform Push { DispatchArgumentsPush push; };

void main() {
  if (invocationIndex() > 0) return;
  const uint count = readCount(push.count, push.most);
  const uint groups = max(ceilDiv(count, push.itemsPerGroup), push.fewestGroups);
  const uint y = max(ceilDiv(groups, kMaxGroups), 1);
  push.entry.at[0] = ceilDiv(groups, y);
  push.entry.at[1] = y;
  push.entry.at[2] = 1;
  push.entry.at[3] = groups * push.scale;
}
