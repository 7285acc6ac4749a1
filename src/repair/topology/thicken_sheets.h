#pragma once

#include <raymap/mesh.h>

#include <cstdint>
#include <vector>

namespace raymap {

/// Plates around the sheets of a mesh, and what they replace.
struct Plates {
  std::vector<uint32_t> sheets;   ///< Faces of the sheets, ascending.
  Mesh mesh = {};                 ///< The plates, closed. They may cross each other and themselves.
  std::vector<uint32_t> sources;  ///< Face of a sheet that each face of a plate belongs to.
};

/// Makes plates of a thickness around the sheets of a mesh whose equal positions are one vertex. Each corner
/// moves to both sides, until its faces have half of the thickness there; at sharp edges, by at most all of
/// it. Rims get walls. Which side the faces point to does not matter.
Plates thickenSheets(const Mesh& mesh, double thickness);

}  // namespace raymap
