// Krayer & Müller 2019, §3.1: the cells of a row along x that a triangle touches. GPU twin of
// cpu/cells/cell_runs.h.

#include "vulkan/stages/cell_lattice.glsl"
#include "vulkan/stages/mesh.glsl"
#include "vulkan/stages/triangle.glsl"
#include "vulkan/stages/cell_runs_push.h"

layout(push_constant, scalar) uniform Push { CellRunsPush push; };

// Cells grow by this share of the triangle's reach, which makes up for rounding in double precision.
const double kSlack = 1e-12lf;

struct Interval {
  double low;
  double high;
};

// Keeps the x with from <= factor * x <= to. An empty interval ends below 0.
void clip(inout Interval interval, double factor, double from, double to) {
  if (factor == 0.0) {
    if (from > 0.0 || to < 0.0) interval.high = -1.0;
    return;
  }
  const double a = from / factor, b = to / factor;
  interval.low = max(interval.low, min(a, b));
  interval.high = min(interval.high, max(a, b));
}

bool isEmpty(Interval interval) {
  return !(interval.low <= interval.high);
}

// Triangle relative to the lowest cell of its bounds, in cells.
struct LocalTriangle {
  dvec3 corner[3];
  ivec3 base;
  ivec3 extent;  // From `base` to the highest cell of its bounds; negative outside the lattice.
  bool isCut;    // Whether its bounds reach beyond the lattice.
};

LocalTriangle readLocalTriangle(uint triangle) {
  LocalTriangle local;
  [[unroll]] for (uint c = 0; c < 3; ++c) {
    precise const dvec3 corner = (dvec3(readCorner(push.vertices, push.triangles, triangle, c)) - firstCentre(push.cells)) / push.cells.size;
    local.corner[c] = corner;
  }
  const dvec3 low = min(min(local.corner[0], local.corner[1]), local.corner[2]);
  const dvec3 high = max(max(local.corner[0], local.corner[1]), local.corner[2]);
  const dvec3 dims = dvec3(push.cells.nx, push.cells.ny, push.cells.nz);
  const dvec3 lowest = ceil(low - 0.5lf), highest = floor(high + 0.5lf);
  const dvec3 base = clamp(lowest, dvec3(0.0), dims), last = clamp(highest, dvec3(-1.0), dims - 1.0lf);
  local.base = ivec3(base);
  local.extent = ivec3(last) - local.base;
  local.isCut = base != lowest || last != highest;
  [[unroll]] for (uint c = 0; c < 3; ++c) local.corner[c] -= base;
  return local;
}

uint rowCount(LocalTriangle local) {
  return any(lessThan(local.extent, ivec3(0))) ? 0 : uint(local.extent.y + 1) * uint(local.extent.z + 1);
}

// Clips by the edges in the projection along an axis.
void clipByEdges(inout Interval interval, LocalTriangle local, uint along, uint axis, uint other, int at,
                 double slack) {
  [[unroll]] for (uint e = 0; e < 3; ++e) {
    const Slab slab = edgeSlab(local.corner, e, along, slack);
    precise const double shift = slab.axis[other] * double(at);
    clip(interval, slab.axis[axis], slab.low - shift, slab.high - shift);
  }
}

// Returns the cells along x, relative to the triangle's lowest one, that it touches in row j, k; possibly
// none.
ivec2 touchedRun(LocalTriangle local, int j, int k) {
  const ivec3 extent = local.extent;
  // Within one line of cells the bounds decide.
  if (!local.isCut && int(extent.x > 0) + int(extent.y > 0) + int(extent.z > 0) <= 1) return ivec2(0, extent.x);
  const dvec3 far = max(max(abs(local.corner[0]), abs(local.corner[1])), abs(local.corner[2]));
  precise const double slack = kSlack * (1.0lf + max(max(far.x, far.y), far.z));
  const ivec2 none = ivec2(0, -1);
  Interval rows = Interval(0.0lf, double(extent.y));
  clipByEdges(rows, local, 0, 1, 2, k, slack);
  if (isEmpty(rows) || double(j) < ceil(rows.low) || double(j) > floor(rows.high)) return none;
  Interval row = Interval(0.0lf, double(extent.x));
  clipByEdges(row, local, 1, 0, 2, k, slack);
  const Slab plane = planeSlab(local.corner, slack);
  precise const double offset = plane.axis.y * double(j) + plane.axis.z * double(k);
  clip(row, plane.axis.x, plane.low - offset, plane.high - offset);
  clipByEdges(row, local, 2, 0, 1, j, slack);
  return isEmpty(row) ? none : ivec2(ceil(row.low), floor(row.high));
}

// Adds to a 64-bit total, once per subgroup.
void addToTotal(uint at, uint value) {
  const uint sum = subgroupAdd(value);
  if (!subgroupElect()) return;
  const uint before = atomicAdd(push.totals.at[at], sum);
  if (before + sum < before) atomicAdd(push.totals.at[at + 1], 1);
}
