#pragma once

#include <raymap/mesh.h>

#include <cstddef>
#include <optional>

#include "mesh/model.h"

namespace raymap {

/// The surface of what a mesh surrounds at least once.
struct UnitedFaces {
  Mesh mesh = {};       ///< Faces that were not cut keep their corners, their order and their positions.
  size_t cutFaces = 0;  ///< Number of faces of the given mesh that were cut.
  double volume = 0.0;  ///< Volume of the exact union, whose vertices are not rounded yet.
  bool isAnyInverted = false;  ///< Whether a part is inside out and lies in no other one.
};

/// Cuts the faces of a balanced mesh where they meet others, and keeps the pieces that have a winding number
/// of 1 or more behind, and of 0 or less in front. Rounds new vertices to single precision, so new faces may
/// cross again by as much. Returns nothing if it takes too much work.
std::optional<UnitedFaces> uniteFaces(const Model& mesh);

}  // namespace raymap
