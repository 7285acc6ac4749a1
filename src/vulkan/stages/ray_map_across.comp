// Sums adjacent lines in memory, one per invocation.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/ray_map_push.h"

layout(push_constant, scalar) uniform Push { RayMapPush push; };

const uint kReadsAtOnce = 16;  // Reads in flight together; the sum waits for each of them in turn.

void main() {
  const uint line = invocationIndex();
  if (line >= push.lineCount) return;
  const uint stride = push.stride;
  const uint first = line / stride * stride * push.edgesOfLine + line % stride;
  const uint begin = push.end - min(push.end, kRayMapPiece);
  int sum = push.end < push.edgesOfLine ? push.edges.at[first + push.end * stride] : 0;
  uint end = push.end;
  for (; end >= begin + kReadsAtOnce; end -= kReadsAtOnce) {
    int counts[kReadsAtOnce];
    [[unroll]] for (uint i = 0; i < kReadsAtOnce; ++i) counts[i] = push.edges.at[first + (end - 1 - i) * stride];
    [[unroll]] for (uint i = 0; i < kReadsAtOnce; ++i) {
      sum += counts[i];
      push.edges.at[first + (end - 1 - i) * stride] = sum;
    }
  }
  for (; end > begin; --end) {
    sum += push.edges.at[first + (end - 1) * stride];
    push.edges.at[first + (end - 1) * stride] = sum;
  }
}
