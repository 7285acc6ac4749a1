// Sums lines whose edges are consecutive in memory, one per subgroup.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/ray_map_push.h"

layout(push_constant, scalar) uniform Push { RayMapPush push; };

const uint kReadsAtOnce = 4;  // Reads in flight together.

void main() {
  const uint line = groupIndex() * gl_NumSubgroups + gl_SubgroupID;
  if (line >= push.lineCount) return;
  const uint first = line * push.edgesOfLine;
  const uint begin = push.end - min(push.end, kRayMapPiece);
  int sum = push.end < push.edgesOfLine ? push.edges.at[first + push.end] : 0;
  for (uint done = 0; done < push.end - begin; done += kReadsAtOnce * gl_SubgroupSize) {
    int counts[kReadsAtOnce];
    [[unroll]] for (uint i = 0; i < kReadsAtOnce; ++i) {
      const uint back = done + i * gl_SubgroupSize + gl_SubgroupInvocationID;
      counts[i] = back < push.end - begin ? push.edges.at[first + push.end - 1 - back] : 0;
    }
    [[unroll]] for (uint i = 0; i < kReadsAtOnce; ++i) {
      const uint back = done + i * gl_SubgroupSize + gl_SubgroupInvocationID;
      const int total = sum + subgroupInclusiveAdd(counts[i]);
      if (back < push.end - begin) push.edges.at[first + push.end - 1 - back] = total;
      sum += subgroupAdd(counts[i]);
    }
  }
}
