#pragma once

// A mesh on a grid, taken through the stages that lead to its sign.

#include <raymap/raymap.h>

#include "cpu/crossings.h"
#include "cpu/ray_map.h"
#include "cpu/winding.h"
#include "reference.h"

#include <cstddef>
#include <string>

namespace raymap {

/// The mesh in cell units: sample (i, j, k) at (i, j, k).
inline CellMesh cellMesh(const Mesh& mesh, const Grid& grid) {
  CellMesh cells;
  cells.vertices.resize(mesh.vertices.size());
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
    cells.vertices[v] = glm::vec3((mesh.position(v) - grid.origin) / grid.spacing);
  cells.triangles = mesh.triangles;
  cells.dims = grid.dims;
  return cells;
}

inline Crossings crossingsOf(const Mesh& mesh, const Grid& grid) {
  const Options options;
  Stats stats;
  Progress progress(options, stats);
  Crossings crossings;
  countCrossings(cellMesh(mesh, grid), progress, crossings);
  return crossings;
}

inline RayMap rayMapOf(const Mesh& mesh, const Grid& grid) {
  RayMap map;
  buildRayMap(grid.dims, crossingsOf(mesh, grid), map);
  return map;
}

struct WindingResult {
  Buffer<float> winding;
  WindingSummary summary;
};

inline WindingResult windingOf(const RayMap& map, const Options& options) {
  WindingResult result;
  Stats stats;
  Progress progress(options, stats);
  result.summary = Winding().compute(map, options, progress, result.winding);
  return result;
}

inline WindingResult windingOf(const Mesh& mesh, const Grid& grid, SignMode mode) {
  Options options;
  options.sign = mode;
  return windingOf(rayMapOf(mesh, grid), options);
}

inline double diagonal(const Mesh& mesh) {
  return glm::length(bounds(mesh).size());
}

/// How many of every `stride`-th sample have a sign other than the exact generalized winding number's, not
/// counting those within 1e-6 of the diagonal from the surface.
inline size_t countWrongSigns(const Mesh& mesh, const Grid& grid, const Buffer<float>& winding,
                              size_t stride = 1, double threshold = 0.5) {
  size_t wrong = 0;
  for (size_t s = 0; s < winding.size(); s += stride) {
    const size_t nx = size_t(grid.dims.x), ny = size_t(grid.dims.y);
    const glm::dvec3 p = grid.position({double(s % nx), double(s / nx % ny), double(s / nx / ny)});
    const bool inside = std::abs(reference::windingNumber(mesh, p)) > threshold;
    if (inside != (std::abs(winding[s]) > threshold) && reference::distance(mesh, p) > 1e-6 * diagonal(mesh))
      ++wrong;
  }
  return wrong;
}

}  // namespace raymap
