#pragma once

#include <raymap/mesh.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "mesh/model.h"

namespace raymap {

/// The surface of what a mesh surrounds at least once.
struct UnitedFaces {
  Mesh mesh = {};            ///< Faces that were not cut keep their corners, their order and their positions.
  size_t cutFaces = 0;       ///< Number of faces of the given mesh that were cut.
  size_t repeatedFaces = 0;  ///< Number of those that were not cut, and lie on others.
  double volume = 0.0;       ///< Volume of the exact union, whose vertices are not rounded yet.
  double buriedShare = 0.0;  ///< Share of the pieces' area that lies within the union.
  std::vector<uint32_t> sources = {};  ///< Given face that each face is, or is a part of.
  std::vector<uint32_t> turned = {};   ///< Faces that are turned, in parts inside out: ascending.
  Mesh open = {};  ///< One side of what has another side right behind it, and no inside around it.
  std::vector<uint32_t> openSources = {};  ///< Given face that each of these is a part of.
};

/// Cuts the faces of a balanced mesh where they meet others, and keeps the pieces that have a winding number
/// of 1 or more behind, and of 0 or less in front. With `mayTurn`, if a part is inside out and lies in no
/// other one, negative numbers are inside, too, as they are for signs; faces around them are turned. Rounds
/// new vertices to single precision, so new faces may cross again by as much. Returns nothing if it takes too
/// much work.
std::optional<UnitedFaces> uniteFaces(const Model& mesh, bool mayTurn);

}  // namespace raymap
