#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Double-sided faces of a mesh. The faces of a group lie on the same three positions, as many of them in
/// one winding order as in the other. They cancel in every winding number.
struct DoubleSidedFaces {
  std::vector<uint32_t> firsts;   ///< Lowest face of each group, ascending.
  std::vector<uint32_t> others;   ///< The remaining faces of all groups, group by group.
  std::vector<uint32_t> groupOf;  ///< Index in `firsts` of the group of each of `others`.

  bool empty() const { return firsts.empty(); }
  size_t count() const { return firsts.size() + others.size(); }
};

/// Finds the double-sided faces. Positions are the same if their coordinates are exactly equal.
DoubleSidedFaces findDoubleSidedFaces(const PackedMesh& mesh);

/// Finds them among these faces, in any order.
DoubleSidedFaces findDoubleSidedFaces(const PackedMesh& mesh, std::span<const uint32_t> faces);

/// Finds them among candidates. Each has a face in its lower half. Faces on the same positions must be
/// neighbours and must have the same upper half.
DoubleSidedFaces findDoubleSidedFaces(const PackedMesh& mesh, std::span<const uint64_t> candidates);

}  // namespace raymap
