#pragma once

#include <raymap/mesh.h>
#include <raymap/verdict.h>

#include <cstddef>
#include <cstdint>

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

/// What parts that are inside out stand for.
enum class InsideOut : uint8_t {
  Turned,      ///< They are turned if they cross others, else there is no union.
  Kept,        ///< There is no union if an outermost part is inside out.
  Subtracted,  ///< They take away from the others.
};

/// Cuts the faces of a mesh where they cross, overlap or touch, and keeps what bounds the union.
UnitedParts uniteParts(const Model& mesh, InsideOut insideOut = InsideOut::Turned);

}  // namespace raymap
