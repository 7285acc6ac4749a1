#pragma once

#include <cstdint>
#include <span>
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

/// Finds the rims among these edges, in any order: all that may be rims, and no edge of no length. Edge k
/// leads from corner k % 3 of face k / 3 to the next one.
std::vector<RimEdge> findRimEdges(const PackedMesh& mesh, std::span<const uint32_t> candidates);

}  // namespace raymap
