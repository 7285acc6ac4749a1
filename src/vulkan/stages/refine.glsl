// Krayer & Müller 2019, §3.3, end. Declarations shared by the kernels.

#include "vulkan/stages/cell_levels.glsl"
#include "vulkan/stages/refine_push.h"
#include "vulkan/stages/surface_tree_push.h"
#include "vulkan/stages/surface_shapes.glsl"

layout(push_constant, scalar) uniform Push { RefinePush push; };

// Closest triangle so far; among equally close ones, the lowest index.
struct Closest {
  float squared;
  uint triangle;
};

void take(inout Closest closest, float squared, uint triangle) {
  if (squared < closest.squared || (squared == closest.squared && triangle < closest.triangle))
    closest = Closest(squared, triangle);
}

// Measures every `step`-th triangle of a cell, starting with number `lane`. Returns the number of measured
// ones.
uint measureCell(CellLevelData level, uint cell, vec3 p, uint lane, uint step, inout Closest closest) {
  const uint begin = level.begins.at[cell];
  if (begin == kNoCell) return 0;
  const uint count = level.count.at[0];
  uint measured = 0;
  for (uint entry = begin + lane; entry < count && level.entryCells.at[entry] == cell; entry += step) {
    if (measured++ > push.mostAlone && step == 1) break;
    const uint t = level.entryTriangles.at[entry];
    take(closest, squaredDistance(readTriangle(push.frames, t), p), t);
  }
  return measured;
}

// Does the same for a sample's nearest cell in a lattice and, with `reach` 1, for that cell's neighbours.
uint measureLevel(CellLevelData level, uvec3 position, uint lane, uint step, inout Closest closest) {
  const CellPoint point = cellPointOf(level.cells, position);
  const uint nearest = level.nearestCell.at[indexOf(point.cell, level.cells.dims)];
  if (nearest == kNoCell) return 0;
  const uvec3 centre = placeOf(nearest, level.cells.dims), dims = level.cells.dims;
  const uvec3 low = centre - min(centre, uvec3(push.reach)), high = min(centre + push.reach, dims - 1);
  uint measured = 0;
  for (uint k = low.z; k <= high.z; ++k)
    for (uint j = low.y; j <= high.y; ++j)
      for (uint i = low.x; i <= high.x; ++i) {
        const uint cell = indexOf(uvec3(i, j, k), dims);
        measured += measureCell(level, cell, vec3(position), lane, step, closest);
        if (measured > push.mostAlone && step == 1) return measured;
      }
  return measured;
}

uint measure(uint index, uint lane, uint step, inout Closest closest) {
  const uvec3 position = placeOf(index, push.dims);
  uint measured = 0;
  for (uint l = 0; l < push.levelCount; ++l)
    measured += measureLevel(push.levels.at[l], position, lane, step, closest);
  return measured;
}

Closest noneYet() {
  return Closest(kLargestFloat, 0xffffffffu);
}

void store(uint index, Closest closest) {
  push.distance.at[index] = sqrt(closest.squared);
  if (uint64_t(push.closest) != 0) push.closest.at[index] = closest.triangle;
}
