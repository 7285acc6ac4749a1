#pragma once

// Meshes in cell units, for tests of single stages on any backend.

#include <raymap/grid.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/progress.h"
#include "cpu/cells/cell_distance.h"
#include "cpu/cells/cell_levels.h"
#include "cpu/cells/distance_transform.h"
#include "cpu/cells/voxel_grid.h"
#include "method/cell_mesh.h"
#include "testing/shapes.h"

namespace raymap {

/// A mesh in cell units that owns its triangles.
struct OwnCellMesh : CellMesh {
  std::vector<glm::uvec3> own;

  OwnCellMesh(const Mesh& mesh, const Grid& grid) : own(mesh.triangles) {
    vertices.resizeUninitialized(mesh.vertices.size());
    for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
      vertices[v] = glm::vec3((mesh.position(v) - grid.origin) / grid.spacing);
    triangles = own;
    dims = grid.dims;
  }
  /// Returns the same surface as a mesh in cell units, for a reference to measure.
  Mesh asMesh() const { return {{vertices.begin(), vertices.end()}, own, glm::dvec3(0.0)}; }
};

inline OwnCellMesh onGrid(const Mesh& mesh, const GridOptions& options) {
  return {mesh, fitGrid(mesh, options)};
}

/// Returns random triangles of 0.02 to 20 cells, all over a grid of these dims and a little beyond.
inline OwnCellMesh cellSoup(int count, glm::ivec3 dims, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto point = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  std::vector<glm::dvec3> p;
  std::vector<glm::uvec3> t;
  for (uint32_t i = 0; i < uint32_t(count); ++i) {
    const glm::dvec3 at = point() * (glm::dvec3(dims) + 2.0) - 1.5;
    const double size = 0.02 * std::pow(1000.0, unit(random));
    for (int c = 0; c < 3; ++c) p.push_back(at + size * (point() - 0.5));
    t.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  return {makeMesh(p, std::move(t)), Grid{dims, glm::dvec3(0.0), 1.0}};
}

/// Returns squared distances of cells of which this share holds triangles.
inline Buffer<float> randomCells(glm::ivec3 dims, double share, unsigned seed, bool isWhole = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Buffer<float> squared(size_t(dims.x) * dims.y * dims.z);
  for (float& f : squared) {
    f = unit(random) < share ? 0.75f * unit(random) : emptyCell(dims);
    if (isWhole && f < 1.0f) f = 0.0f;
  }
  return squared;
}

/// Runs the stages from the voxel grid to the distance transform.
inline std::vector<cpu::CellLevel> nearestCells(const CellMesh& mesh) {
  Progress progress;
  std::vector<cpu::CellLevel> levels;
  for (const CellLattice& cells : coverMesh(mesh)) {
    cpu::CellLevel& level = levels.emplace_back();
    buildVoxelGrid(mesh, cells, SIZE_MAX, progress, level.grid);
    computeCellDistance(mesh, level.grid, progress, level.squared);
    cpu::transformDistance(cells.dims, progress, level.squared, level.nearestCell);
  }
  return levels;
}

}  // namespace raymap
