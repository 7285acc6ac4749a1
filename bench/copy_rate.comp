// Copies a buffer, 16 bytes per invocation.
#include "vulkan/device/kernel.glsl"
#include "copy_rate_push.h"

layout(push_constant, scalar) uniform Push { CopyRatePush push; };

void main() {
  const uint i = invocationIndex();
  if (i < push.count) push.to.at[i] = push.from.at[i];
}
