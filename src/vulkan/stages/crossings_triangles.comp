// Scans the triangles that take few steps, and counts the runs of the others.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/primitives/int128.glsl"
#include "vulkan/stages/crossings.glsl"

// Narrow triangles only: their orient2d fits into 64 bits.
#define Wide int64_t
Wide product(int64_t a, int64_t b) {
  return a * b;
}
Wide sum(Wide a, Wide b) {
  return a + b;
}
Wide negative(Wide a) {
  return -a;
}
bool isPositive(Wide a) {
  return a > 0;
}
#include "vulkan/stages/crossings_lines.glsl"

bool isNarrow(SnappedTriangle t) {
  const i64vec3 extent = max(max(t.a, t.b), t.c) - min(min(t.a, t.b), t.c);
  return max(max(extent.x, extent.y), extent.z) < (1l << kNarrowBits);
}

void scanTriangle(SnappedTriangle t, int bits) {
  for (uint axis = 0; axis < 3; ++axis) {
    const uvec2 lines = linesAlong(t, axis);
    Facet facet;
    if (lines.x == 0 || !makeFacet(t, axis, facet)) continue;
    const ivec3 begin = inFrame(t.begin, axis), end = inFrame(t.end, axis);
    for (int v = begin.y; v < end.y; ++v)
      scanRun(facet, axis, ivec2(begin.x, v), int(lines.x), ivec2(begin.z, end.z), bits);
  }
}

// Returns the number of runs of a triangle that takes too many steps to be scanned here; scans other
// triangles and returns 0.
uint countRuns(uint triangle) {
  const int bits = fractionBits();
  const SnappedTriangle t = snapTriangle(triangle, bits);
  uint stepCount = 0, runCount = 0;
  for (uint axis = 0; axis < 3; ++axis) {
    const uvec2 lines = linesAlong(t, axis);
    stepCount += (lines.x + kRowSteps) * lines.y;
    runCount += ceilDiv(lines.x, kRunLines) * lines.y;
  }
  if (stepCount > kFewSteps || !isNarrow(t)) return runCount;
  scanTriangle(t, bits);
  return 0;
}

// Adds to a 64-bit number, in any order. The invocation that makes the lower half wrap carries.
void addRuns(uint64_t runs) {
  const uint low = uint(runs);
  const uint before = atomicAdd(push.status.now.runs, low);
  const uint carry = uint(runs >> 32) + uint(before + low < before);
  if (carry > 0) atomicAdd(push.status.now.runsHigh, carry);
}

void main() {
  const uint triangle = invocationIndex();
  const bool isInside = triangle < push.triangleCount;
  const uint runs = isInside && !isTooFar() ? countRuns(triangle) : 0;
  if (isInside) push.runs.at[triangle] = runs;
  const uint64_t low = subgroupAdd(runs & 0xFFFF), high = subgroupAdd(runs >> 16);
  if (subgroupElect() && (low | high) != 0) addRuns(low + (high << 16));
}
