// Krayer & Müller 2019, §3.3: one entry of the voxel grid per invocation.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/cell_lattice.glsl"
#include "vulkan/stages/mesh.glsl"
#include "vulkan/stages/triangle.glsl"
#include "vulkan/stages/cell_distance_push.h"

layout(push_constant, scalar) uniform Push { CellDistancePush push; };

void main() {
  const uint entry = push.firstGroup * gl_WorkGroupSize.x + invocationIndex();
  uint cell = kNoCell, squared = 0xffffffffu;  // Bits of a nonnegative float, which keep the floats' order.
  if (entry < min(push.count.at[0], push.mostEntries)) {
    const uint t = push.entryTriangles.at[entry];
    cell = push.entryCells.at[entry];
    const vec3 centre = cellCentre(push.cells, placeOf(cell, push.cells.dims));
    const mat3 corners = cornersOf(push.vertices, push.triangles, t);
    squared = floatBitsToUint(push.perCell2 * triangleSquaredDistance(centre, corners[0], corners[1], corners[2]));
  }
  // The entries of a crowded cell are contiguous, so each of their subgroups needs one atomic operation.
  const uint least = subgroupMin(squared);
  const bool isSame = subgroupMin(cell) == subgroupMax(cell), isFirst = subgroupElect();
  if (cell != kNoCell && (isFirst || !isSame)) atomicMin(push.squared.at[cell], isSame ? least : squared);
}
