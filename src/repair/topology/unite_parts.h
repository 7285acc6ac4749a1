#pragma once

#include <raymap/mesh.h>

#include <cstddef>
#include <optional>

#include "mesh/inverted_parts.h"
#include "mesh/model.h"

namespace raymap {

/// A mesh with nothing wrong that is the union of the parts of another one.
struct UnitedParts {
  Mesh mesh = {};
  size_t cutFaces = 0;          ///< Number of faces that were cut, also to part solids at edges.
  InvertedParts inverted = {};  ///< Parts that were inside out and were turned.
};

/// Cuts the faces of a mesh where they cross, overlap or touch, and keeps what bounds the union. With
/// `mayTurn`, turns parts first that are inside out and cross others. Returns nothing if the mesh is not
/// balanced, or if anything is wrong with the result.
std::optional<UnitedParts> uniteParts(const Model& mesh, bool mayTurn);

}  // namespace raymap
