// Krayer & Müller 2019, §3.3, last paragraph: the distance of every sample, from the transform of the cells'
// distances.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/cell_levels.glsl"
#include "vulkan/stages/triangle.glsl"
#include "vulkan/stages/raster_distance_push.h"

layout(push_constant, scalar) uniform Push { RasterDistancePush push; };

// Evaluates at p the parabola that gives the transform's value at the centre of p's cell.
float squaredDistance(CellLevelData level, CellPoint p, uint nearestCell) {
  const vec3 nearest = vec3(placeOf(nearestCell, level.cells.dims));
  const vec3 d = vec3(p.cell) - nearest;
  precise const float value = d.z * d.z + (d.y * d.y + (d.x * d.x + level.squared.at[nearestCell]));
  if (p.at == vec3(p.cell)) return value;
  precise const float shift = squaredLength(p.at - nearest) - squaredLength(d);
  return max(0.0, value + shift);
}

void main() {
  const uint index = invocationIndex();
  if (index >= countOf(push.dims)) return;
  const uvec3 position = placeOf(index, push.dims);
  float distance = kLargestFloat;
  for (uint l = 0; l < push.levelCount; ++l) {
    CellLevelData level = push.levels.at[l];
    const CellPoint p = cellPointOf(level.cells, position);
    const uint nearest = level.nearestCell.at[indexOf(p.cell, level.cells.dims)];
    if (nearest == kNoCell) continue;
    distance = min(distance, float(level.cells.size) * sqrt(squaredDistance(level, p, nearest)));
  }
  push.distance.at[index] = distance;
}
