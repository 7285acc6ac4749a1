#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/unite_faces.h"

namespace raymap {

/// The union of a mesh, rounded to single precision without faces that cross.
struct SettledUnion {
  Mesh mesh = {};
  std::vector<uint32_t> sources = {};  ///< Face of the closed mesh that each face is a part of.
  UnitedFaces exact = {};              ///< The union before anything was rounded or moved.
  size_t partedFaces = 0;              ///< Number of faces that were cut to part solids at edges.
  size_t movedVertices = 0;            ///< Number of vertices of the closed mesh that were moved.
  bool isRight = false;                ///< Whether nothing is wrong with it.
};

/// Unites a balanced mesh (`uniteFaces`) and rounds the result. If faces cross then, it unites that again.
/// Walls that lie almost in one plane may cross ever more often. Then the corners of crossing faces move in
/// the mesh, and all starts anew: at most seven times, by up to 2e-6 of the mesh's size, and twice as much
/// each time, until it is 3.2e-5. If that does not end, and the mesh has degenerate faces, these stay, as
/// others cross without them.
SettledUnion settleUnion(Mesh closed, bool mayTurn);

}  // namespace raymap
