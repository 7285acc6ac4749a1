#pragma once

// Krayer & Müller 2019, §3.1.
//
// Paper: conservative rasterization along the dominant axis, then a triangle-box test in each cell along z.
// Here: rows of cells along x. Each separating axis bounds the cell centre by a slab, so the cells of a row
// that touch the triangle form one interval. It is found without testing cells, because a large triangle then
// costs no more than the cells that it touches.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "cpu/cells/triangle.h"
#include "cpu/cells/voxel_grid.h"
#include "method/cell_runs_shared.h"

namespace raymap::cpu {

inline constexpr auto kSlack = std::bit_cast<double>(kSlackBits);

struct Interval {
  double low;
  double high;

  /// Keeps the x with from <= factor * x <= to.
  void clip(double factor, double from, double to) {
    if (factor == 0.0) {
      if (from > 0.0 || to < 0.0) high = -INFINITY;
      return;
    }
    const double a = from / factor, b = to / factor;
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  bool isEmpty() const { return !(low <= high); }
  int first() const { return static_cast<int>(std::ceil(low)); }
  int last() const { return static_cast<int>(std::floor(high)); }
};

/// Triangle relative to the lowest cell that its bounds touch, in cells.
struct LocalTriangle {
  std::array<glm::dvec3, 3> corner;
  glm::ivec3 base;
  glm::ivec3 last;  ///< Highest cell that its bounds touch; below `base` if they lie outside the lattice.
  bool isCut;       ///< Whether part of its bounds lies outside the lattice.

  double reach() const {
    const glm::dvec3 far = glm::max(glm::max(glm::abs(corner[0]), glm::abs(corner[1])), glm::abs(corner[2]));
    return std::max({far.x, far.y, far.z});
  }
};

inline LocalTriangle localTriangle(const CellMesh& mesh, const CellLattice& cells, size_t triangle) {
  LocalTriangle local;
  for (int c = 0; c < 3; ++c)
    local.corner[c] = (glm::dvec3(mesh.corner(triangle, c)) - cells.first) / cells.size;
  const glm::dvec3 low = glm::min(glm::min(local.corner[0], local.corner[1]), local.corner[2]);
  const glm::dvec3 high = glm::max(glm::max(local.corner[0], local.corner[1]), local.corner[2]);
  const glm::dvec3 dims(cells.dims);
  const glm::dvec3 lowest = glm::ceil(low - 0.5), highest = glm::floor(high + 0.5);
  local.base = glm::clamp(lowest, glm::dvec3(0.0), dims);
  local.last = glm::clamp(highest, glm::dvec3(-1.0), dims - 1.0);
  local.isCut = glm::dvec3(local.base) != lowest || glm::dvec3(local.last) != highest;
  for (glm::dvec3& corner : local.corner) corner -= glm::dvec3(local.base);
  return local;
}

/// Calls visit(first, end) with the indices of every run of cells along x that the triangle touches.
template <class Visit>
void forEachRun(const CellMesh& mesh, const CellLattice& cells, size_t triangle, Visit&& visit) {
  const LocalTriangle local = localTriangle(mesh, cells, triangle);
  const glm::ivec3 extent = local.last - local.base;
  if (extent.x < 0 || extent.y < 0 || extent.z < 0) return;
  const auto run = [&](int first, int last, int j, int k) {
    const size_t row = cells.index(local.base + glm::ivec3(0, j, k));
    if (first <= last) visit(row + first, row + last + 1);
  };
  // A triangle whose bounds lie in one line of cells touches all cells of its bounds.
  if (!local.isCut && (extent.x > 0) + (extent.y > 0) + (extent.z > 0) <= 1) {
    for (int k = 0; k <= extent.z; ++k)
      for (int j = 0; j <= extent.y; ++j) run(0, extent.x, j, k);
    return;
  }
  const std::array<Slab, 10> slabs = triangleBoxSlabs(local.corner, kSlack * (1.0 + local.reach()));
  const Slab& plane = slabs[0];
  for (int k = 0; k <= extent.z; ++k) {
    Interval rows{0.0, double(extent.y)};   // Bounds on j from the edges seen along x.
    Interval slice{0.0, double(extent.x)};  // Bounds on i from the edges seen along y.
    for (int e = 1; e <= 3; ++e) {
      const Slab &alongX = slabs[e], &alongY = slabs[3 + e];
      rows.clip(alongX.axis.y, alongX.low - alongX.axis.z * k, alongX.high - alongX.axis.z * k);
      slice.clip(alongY.axis.x, alongY.low - alongY.axis.z * k, alongY.high - alongY.axis.z * k);
    }
    if (rows.isEmpty() || slice.isEmpty()) continue;
    for (int j = rows.first(); j <= rows.last(); ++j) {
      Interval row = slice;  // Adds the bounds on i from the plane and the edges seen along z.
      const double offset = plane.axis.y * j + plane.axis.z * k;
      row.clip(plane.axis.x, plane.low - offset, plane.high - offset);
      for (int e = 7; e <= 9; ++e)
        row.clip(slabs[e].axis.x, slabs[e].low - slabs[e].axis.y * j, slabs[e].high - slabs[e].axis.y * j);
      if (!row.isEmpty()) run(row.first(), row.last(), j, k);
    }
  }
}

}  // namespace raymap::cpu
