#pragma once

#include <raymap/buffer.h>
#include <raymap/grid.h>

#include <span>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Conversion of a mesh's positions into the cell units of a grid.
struct CellUnits {
  glm::dvec3 shift{0.0};
  double scale = 1.0;

  glm::vec3 operator()(const glm::vec3& position) const {
    return glm::vec3((shift + glm::dvec3(position)) * scale);
  }
};

/// Mesh in cell units over a grid: sample (i, j, k) lies at (i, j, k). The cell around it reaches half a unit
/// to every side (§3.5). All stages start from these single-precision positions, so they see the same
/// surface.
struct CellMesh {
  Buffer<glm::vec3> vertices;
  std::span<const glm::uvec3> triangles;
  glm::ivec3 dims{0};
  PackedMesh given;  ///< The mesh that was converted.
  CellUnits units;

  glm::vec3 corner(size_t triangle, int c) const { return vertices[triangles[triangle][c]]; }
};

/// Converts a mesh to cell units. `cells` refers to the arrays of `mesh`.
void toCellUnits(const PackedMesh& mesh, const Grid& grid, CellMesh& cells);

}  // namespace raymap
