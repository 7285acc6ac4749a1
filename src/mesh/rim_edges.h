#pragma once

#include <cstdint>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// An edge that the faces of a mesh pass `times` times more often from vertex `from` to vertex `to` than
/// back.
struct RimEdge {
  uint32_t from, to;
  uint32_t times;
};

/// An edge that the faces pass once more often from `from` to `to` than back.
struct RimLine {
  glm::vec3 from, to;
};

/// Finds the rims of a surface: the edges at which it does not end evenly. Every other edge is passed as
/// often in one direction as in the other. Positions are the same if their coordinates are exactly equal. The
/// size of a cell, in the mesh's units, decides the speed only.
std::vector<RimEdge> findRimEdges(const PackedMesh& mesh, double cell);

}  // namespace raymap
