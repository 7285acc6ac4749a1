#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Volume and bounds of a part of a surface. Coordinates are relative to the mesh's origin.
struct MeasuredPart {
  glm::dvec3 low{INFINITY}, high{-INFINITY};
  glm::dvec3 normal{0.0};       ///< Sum of the normals of its faces, each twice as long as its area.
  double area = 0.0;            ///< Twice its area.
  double volume = 0.0;          ///< Seen from the centre of its bounds.
  uint32_t first = UINT32_MAX;  ///< Its lowest face.

  /// Returns +1 if the part encloses a volume and points outwards, -1 if inwards, and 0 if it encloses none.
  /// A part with holes has another volume from each point. It counts if the sign is the same from all points
  /// in its bounds, and the holes are less than a half sphere's.
  int side() const;
  /// Returns whether the bounds of two parts meet.
  bool meets(const MeasuredPart& other) const {
    return glm::all(glm::lessThanEqual(low, other.high)) && glm::all(glm::lessThanEqual(other.low, high));
  }
};

/// The part of each face, and all parts.
struct MeasuredParts {
  std::vector<uint32_t> ofFace;
  std::vector<MeasuredPart> parts;

  /// Returns whether some parts point outwards, and others inwards.
  bool areMixed() const;
};

/// Measures parts, from the part of each face.
MeasuredParts measureParts(const PackedMesh& mesh, std::vector<uint32_t> ofFace, size_t count);

/// Measures the parts that are connected through vertices. Returns none if there is only one. `ids` numbers
/// the positions of the vertices; without it, each vertex is a position of its own.
MeasuredParts measureConnectedParts(const PackedMesh& mesh, std::span<const uint32_t> ids = {});

}  // namespace raymap
