// Scans one run per invocation: some lines of one row of a triangle.
#include "vulkan/device/kernel.glsl"
#include "vulkan/primitives/int128.glsl"
#include "vulkan/stages/crossings.glsl"

#define Wide Int128
#define product longProduct
#include "vulkan/stages/crossings_lines.glsl"

// Returns the last triangle whose first run is at most `run`.
uint triangleOf(uint run) {
  uint begin = 0, end = push.triangleCount;
  while (end - begin > 1) {
    const uint middle = (begin + end) / 2;
    if (push.runs.at[middle] <= run)
      begin = middle;
    else
      end = middle;
  }
  return begin;
}

void main() {
  uint run = push.firstGroup * gl_WorkGroupSize.x + invocationIndex();
  const bool areTooMany = push.status.now.runsHigh > 0 || push.status.now.runs > kMostRuns;
  if (areTooMany || run >= push.status.now.runs) return;
  const uint triangle = triangleOf(run);
  run -= push.runs.at[triangle];
  const int bits = fractionBits();
  const SnappedTriangle t = snapTriangle(triangle, bits);
  uint axis = 0;
  uvec2 lines = linesAlong(t, 0);
  while (run >= ceilDiv(lines.x, kRunLines) * lines.y) {
    run -= ceilDiv(lines.x, kRunLines) * lines.y;
    lines = linesAlong(t, ++axis);
  }
  Facet facet;
  if (!makeFacet(t, axis, facet)) return;
  const uint runsOfRow = ceilDiv(lines.x, kRunLines);
  const uint offset = run % runsOfRow * kRunLines;
  const ivec3 begin = inFrame(t.begin, axis), end = inFrame(t.end, axis);
  const ivec2 first = begin.xy + ivec2(offset, run / runsOfRow);
  scanRun(facet, axis, first, int(min(lines.x - offset, kRunLines)), ivec2(begin.z, end.z), bits);
}
