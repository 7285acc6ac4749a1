// Krayer & Müller 2019, §3.3, last paragraph: the cells of a group's runs.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/cell_lattice.glsl"
#include "vulkan/stages/mesh.glsl"
#include "vulkan/stages/run_cells.glsl"
#include "vulkan/stages/triangle.glsl"
#include "vulkan/stages/raster_distance_push.h"

layout(push_constant, scalar) uniform Push { RasterDistancePush push; };

vec3 corner(uint triangle, uint c) {
  return readCorner(push.vertices, push.triangles, triangle, c);
}

void main() {
  const uint rows = push.totals.at[0], firstRun = groupIndex() * kRunsGroup;
  const bool fits = push.totals.at[1] == 0 && rows <= push.mostRows;
  if (!fits || firstRun >= rows) return;
  loadRunStarts(push.runStarts, rows);
  for (uint number = gl_LocalInvocationIndex; number < runStarts[kRunsGroup]; number += gl_WorkGroupSize.x) {
    const uint run = runOf(number), t = push.runTriangles.at[firstRun + run];
    const uint cell = push.runCells.at[firstRun + run] + (number - runStarts[run]);
    const vec3 centre = cellCentre(push.cells, cellAt(push.cells, cell));
    const float squared =
        push.perCell2 * triangleSquaredDistance(centre, corner(t, 0), corner(t, 1), corner(t, 2));
    atomicMin(push.squared.at[cell], floatBitsToUint(squared));
  }
}
