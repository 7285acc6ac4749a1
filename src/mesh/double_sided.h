#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Faces that lie on others: on the same three positions. They form groups.
///
/// A double-sided group has as many faces in one winding order as in the other. They cancel in every winding
/// number. Every other group is taken as one face, the lowest in the winding order of most; the rest of it is
/// repeated, unless the mesh needs it to be as balanced as it is (`surplusFaces`).
struct DoubleSidedFaces {
  std::vector<uint32_t> firsts;    ///< Lowest face of each double-sided group, ascending.
  std::vector<uint32_t> others;    ///< The remaining faces of these groups, group by group.
  std::vector<uint32_t> groupOf;   ///< Index in `firsts` of the group of each of `others`.
  std::vector<uint32_t> repeated;  ///< Repeated faces, ascending.

  /// Returns whether there is no double-sided group.
  bool empty() const { return firsts.empty(); }
  /// Returns the number of faces in double-sided groups.
  size_t count() const { return firsts.size() + others.size(); }
};

/// Finds the faces that lie on others. Positions are the same if their coordinates are exactly equal.
DoubleSidedFaces findDoubleSidedFaces(const PackedMesh& mesh);

/// Finds them among these faces, in any order.
DoubleSidedFaces findDoubleSidedFaces(const PackedMesh& mesh, std::span<const uint32_t> faces);

/// Finds them among candidates. Each has a face in its lower half. Faces on the same positions must be
/// neighbours and must have the same upper half.
DoubleSidedFaces findDoubleSidedFaces(const PackedMesh& mesh, std::span<const uint64_t> candidates);

}  // namespace raymap
