#pragma once

#include <raymap/mesh.h>

#include <cstddef>
#include <cstdint>
#include <span>

namespace raymap {

/// Vertices of faces that lie at least 10^9 sizes of the others away, as one wrong bit puts them there.
struct FarVertices {
  size_t count = 0;       ///< Number of their distinct positions.
  uint32_t vertex = 0;    ///< The farthest one.
  size_t face = 0;        ///< First face that uses it.
  double distance = 0.0;  ///< How far it lies from the box of the others, along the axis where it is most.
  double size = 0.0;      ///< Longest side of this box.
  Box others = {};        ///< Bounds of the other vertices of faces; of all, if none is far.
};

/// Finds them. `bounds` are those of the vertices that triangles use, which must be finite. Costs no time
/// unless these are large beside the quartiles of a few thousand corners.
FarVertices findFarVertices(const Box& bounds, std::span<const glm::vec3> positions,
                            std::span<const glm::uvec3> triangles);
FarVertices findFarVertices(const Box& bounds, std::span<const glm::dvec3> positions,
                            std::span<const glm::uvec3> triangles);

}  // namespace raymap
