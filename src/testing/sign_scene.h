#pragma once

// Runs a mesh on a grid through the stages that lead to its sign.

#include <raymap/generate.h>

#include "cpu/sign/crossings.h"
#include "cpu/sign/ray_map.h"
#include "testing/reference.h"

#include <cstddef>
#include <string>
#include <utility>

namespace raymap {

using namespace cpu;

/// Returns the mesh in cell units: sample (i, j, k) lies at (i, j, k).
inline CellMesh cellMesh(const Mesh& mesh, const Grid& grid) {
  CellMesh cells;
  cells.vertices.resizeUninitialized(mesh.vertices.size());
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
    cells.vertices[v] = glm::vec3((mesh.position(v) - grid.origin) / grid.spacing);
  cells.triangles = mesh.triangles;
  cells.dims = grid.dims;
  return cells;
}

inline Crossings crossingsOf(const Mesh& mesh, const Grid& grid) {
  Progress progress;
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
  double doubtfulShare = 0.0;
};

/// Returns the winding numbers of a whole run.
inline WindingResult windingOf(const Mesh& mesh, const Grid& grid, FieldOptions options,
                               const MachineOptions& machine = {}) {
  options.winding = true;
  Generated run = generate(mesh, grid, options, machine);
  return {std::move(run.field.winding), run.stats.doubtfulShare};
}

inline WindingResult windingOf(const Mesh& mesh, const Grid& grid, SignMode mode) {
  FieldOptions options;
  options.sign = mode;
  options.orientation = Orientation::Keep;
  return windingOf(mesh, grid, options);
}

inline double diagonal(const Mesh& mesh) {
  return glm::length(bounds(mesh).size());
}

inline glm::dvec3 samplePosition(const Grid& grid, size_t s) {
  const size_t nx = size_t(grid.dims.x), ny = size_t(grid.dims.y);
  return grid.position(glm::dvec3(glm::u64vec3(s % nx, s / nx % ny, s / nx / ny)));
}

/// Counts, among every `stride`-th sample, those whose sign is not that of the exact generalized winding
/// number. Samples within 1e-6 of the diagonal from the surface are ignored.
inline size_t countWrongSigns(const Mesh& mesh, const Grid& grid, const Buffer<float>& winding,
                              size_t stride = 1, double threshold = 0.5) {
  size_t wrong = 0;
  for (size_t s = 0; s < winding.size(); s += stride) {
    const glm::dvec3 p = samplePosition(grid, s);
    const bool inside = std::abs(reference::windingNumber(mesh, p)) > threshold;
    if (inside != (std::abs(winding[s]) > threshold) && reference::distance(mesh, p) > 1e-6 * diagonal(mesh))
      ++wrong;
  }
  return wrong;
}

}  // namespace raymap
