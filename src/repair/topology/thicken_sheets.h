#pragma once

#include <raymap/mesh.h>

#include <cstdint>
#include <vector>

namespace raymap {

/// Plates around the sheets of a mesh.
struct Plates {
  Mesh mesh = {};                 ///< The plates, closed. They may cross each other and themselves.
  std::vector<uint32_t> sources;  ///< Face of a sheet that each face of a plate belongs to.
  double foldedShare = 0.0;       ///< Share of the sheets' area that faces the other way on one side.
};

/// Makes plates of a thickness around the faces of sheets of a mesh whose equal positions are one vertex.
/// Each corner moves to both sides, until its faces have half of the thickness there; at sharp edges, by at
/// most all of it. Rims get walls. Which side the faces point to does not matter.
Plates thickenSheets(const Mesh& mesh, const std::vector<uint32_t>& faces, double thickness);

}  // namespace raymap
