// Sets the number of groups to 0 for dispatches behind a closed gate.
#include "vulkan/device/kernel.glsl"
#include "vulkan/primitives/gate_push.h"

layout(push_constant, scalar) uniform Push { GatePush push; };

void main() {
  const uint i = invocationIndex();
  if (i < push.count) push.actual.at[i] = push.word.at[0] == 0 ? 0 : push.planned.at[i];
}
