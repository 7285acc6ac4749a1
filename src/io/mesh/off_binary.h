#pragma once

#include <vector>

#include "io/mesh/mesh_file.h"

namespace raymap {

/// Words before the numbers of vertices and faces.
struct OffHeader {
  bool hasNormal = false, hasColour = false, hasTexture = false, isHomogeneous = false;
  bool isBinary = false;
  size_t bytes = 0;  ///< Size of the words, after which the numbers begin.

  /// Returns how many numbers of a vertex follow its coordinates, if its colour has `colours`.
  int numbers(int colours) const {
    return (hasNormal ? 3 : 0) + (hasColour ? colours : 0) + (hasTexture ? 2 : 0);
  }
};

struct OffMesh {
  std::vector<glm::dvec3> positions;
  Polygons polygons;
  bool hasFaceColours = false;
};

/// Reads what follows the header of a binary file: numbers of 32 bits, the highest byte first.
OffMesh readBinaryOff(const MeshFile& file, const OffHeader& header);

}  // namespace raymap
