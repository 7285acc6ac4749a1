// Krayer & Müller 2019, §3.1: rows along x of the cells in a triangle's bounds. GPU twin of cpu/cells/cell_runs.h.

#include "vulkan/stages/cell_lattice.glsl"
#include "vulkan/stages/mesh.glsl"
#include "vulkan/stages/voxel_grid_push.h"

layout(push_constant, scalar) uniform Push { VoxelGridPush push; };

// Triangle, and the cells of its bounds.
struct LocalTriangle {
  vec3 a, b, c;
  ivec3 base;    // Lowest cell of its bounds.
  ivec3 extent;  // From `base` to the highest cell of its bounds; negative outside the lattice.
  bool isCut;    // Whether its bounds reach beyond the lattice.
};

// Returns the integers nearest to x, the greater one of two; beyond 2^30, any beyond 2^30.
ivec3 nearestIntegers(vec3 x) {
  const float kFarthestCell = 2147483520.0;
  const vec3 whole = floor(x);
  return ivec3(clamp(whole + vec3(greaterThanEqual(x - whole, vec3(0.5))), vec3(-kFarthestCell), vec3(kFarthestCell)));
}

// Finds the lowest and the highest cell that the bounds touch.
void findBounds(vec3 low, vec3 high, inout ivec3 lowest, inout ivec3 highest) {
  if (isOfSamples(push.lattice)) {
    lowest = -nearestIntegers(-low);
    highest = nearestIntegers(high);
    return;
  }
  [[dont_unroll]] for (uint axis = 0; axis < 3; ++axis) {
    lowest = ivec3(lowest.yz, ceilOf(difference(inCells(push.lattice, axis, doubleOf(low.x)), kHalf)));
    highest = ivec3(highest.yz, floorOf(sum(inCells(push.lattice, axis, doubleOf(high.x)), kHalf)));
    low = low.yzx;
    high = high.yzx;
  }
}

LocalTriangle readLocalTriangle(uint triangle) {
  LocalTriangle local;
  const mat3 corners = cornersOf(push.vertices, push.triangles, triangle);
  local.a = corners[0];
  local.b = corners[1];
  local.c = corners[2];
  ivec3 lowest = ivec3(0), highest = ivec3(0);
  findBounds(min(min(local.a, local.b), local.c), max(max(local.a, local.b), local.c), lowest, highest);
  const ivec3 dims = ivec3(push.lattice.dims);
  local.base = clamp(lowest, ivec3(0), dims);
  const ivec3 last = clamp(highest, ivec3(-1), dims - 1);
  local.extent = last - local.base;
  local.isCut = local.base != lowest || last != highest;
  return local;
}

uint rowCount(LocalTriangle local) {
  return any(lessThan(local.extent, ivec3(0))) ? 0 : uint(local.extent.y + 1) * uint(local.extent.z + 1);
}

// Row of cells in a triangle's bounds.
struct Row {
  uint triangle;
  uint number;  // Among the triangle's rows.
  LocalTriangle local;
  int j, k;  // Relative to the triangle's lowest cell.
};

Row readRow(uint triangle, uint number) {
  const LocalTriangle local = readLocalTriangle(triangle);
  const uint rows = uint(local.extent.y + 1);
  return Row(triangle, number, local, int(number % rows), int(number / rows));
}
