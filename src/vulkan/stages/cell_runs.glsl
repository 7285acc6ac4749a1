// Krayer & Müller 2019, §3.1: the cells of a row along x that a triangle touches. GPU twin of
// cpu/cells/cell_runs.h.

#include "vulkan/stages/cell_lattice.glsl"
#include "vulkan/stages/mesh.glsl"
#include "vulkan/stages/cell_runs_push.h"

layout(push_constant, scalar) uniform Push { CellRunsPush push; };

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
  if (isOfSamples(push.cells)) {
    lowest = -nearestIntegers(-low);
    highest = nearestIntegers(high);
    return;
  }
  [[dont_unroll]] for (uint axis = 0; axis < 3; ++axis) {
    lowest = ivec3(lowest.yz, ceilOf(difference(inCells(push.cells, axis, doubleOf(low.x)), kHalf)));
    highest = ivec3(highest.yz, floorOf(sum(inCells(push.cells, axis, doubleOf(high.x)), kHalf)));
    low = low.yzx;
    high = high.yzx;
  }
}

LocalTriangle readLocalTriangle(uint triangle) {
  LocalTriangle local;
  local.a = readCorner(push.vertices, push.triangles, triangle, 0);
  local.b = readCorner(push.vertices, push.triangles, triangle, 1);
  local.c = readCorner(push.vertices, push.triangles, triangle, 2);
  ivec3 lowest = ivec3(0), highest = ivec3(0);
  findBounds(min(min(local.a, local.b), local.c), max(max(local.a, local.b), local.c), lowest, highest);
  const ivec3 dims = ivec3(push.cells.nx, push.cells.ny, push.cells.nz);
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
  uint number;  // Among the rows of all triangles.
  LocalTriangle local;
  int j, k;  // Relative to the triangle's lowest cell.
};

Row readRow(uint number, uint triangle) {
  Row row;
  row.number = number;
  row.local = readLocalTriangle(triangle);
  const uint ofTriangle = number - push.rowStarts.at[triangle], rows = uint(row.local.extent.y + 1);
  row.j = int(ofTriangle % rows);
  row.k = int(ofTriangle / rows);
  return row;
}

// Writes the cells along x, relative to the triangle's lowest one, that it touches in a row; possibly none. Returns their
// number.
uint writeRun(Row row, ivec2 run) {
  const uint size = uint(max(run.y - run.x + 1, 0));
  push.runCells.at[row.number] = cellIndex(push.cells, uvec3(row.local.base + ivec3(run.x, row.j, row.k)));
  push.runSizes.at[row.number] = size;
  return size;
}

// Adds to a 64-bit total, once per subgroup. All invocations of the group call it.
void addToTotal(uint at, uint value) {
  const uint sum = subgroupAdd(value);
  if (sum == 0 || !subgroupElect()) return;
  const uint before = atomicAdd(push.totals.at[at], sum);
  if (before + sum < before) atomicAdd(push.totals.at[at + 1], 1);
}
