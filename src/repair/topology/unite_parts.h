#pragma once

#include <raymap/mesh.h>
#include <raymap/verdict.h>

#include <cstddef>

#include "mesh/inverted_parts.h"
#include "mesh/model.h"

namespace raymap {

/// A mesh with nothing wrong that is the union of the parts of another one.
struct UnitedParts {
  Mesh mesh = {};
  size_t cutFaces = 0;                      ///< Number of faces that were cut, also to part solids at edges.
  InvertedParts inverted = {};              ///< Parts that were inside out and were turned.
  FieldReason failure = FieldReason::None;  ///< Why there is no such mesh.
};

/// Cuts the faces of a mesh where they cross, overlap or touch, and keeps what bounds the union. With
/// `mayTurn`, turns parts first that are inside out and cross others.
UnitedParts uniteParts(const Model& mesh, bool mayTurn);

}  // namespace raymap
