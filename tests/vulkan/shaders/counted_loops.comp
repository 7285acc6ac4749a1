#include "vulkan/device/kernel.glsl"
#include "counted_loops.h"

layout(push_constant, scalar) uniform Push { CountedLoopsPush push; };

uint sumOf(uint count) {
  uint sum = 0;
  for (uint i = 0; i < count; ++i) sum += push.values.at[i];
  return sum;
}

void main() {
  const uint index = invocationIndex();
  push.sums.at[index] = sumOf(push.first + push.more * index);
}
