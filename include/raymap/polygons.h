#pragma once

#include <raymap/export.h>

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace raymap {

/// Triangles of polygons.
struct CutPolygons {
  std::vector<glm::uvec3> triangles = {};
  /// Number of polygons that cross themselves, or whose corners lie on a line. They are fans of triangles
  /// around their first corners, which may overlap.
  size_t uncut = 0;
};

/// Cuts polygons into triangles that cover them without overlap, in the order of the polygons. `corners` has
/// the vertices of all polygons after each other, `sizes` the number of corners of each. A convex polygon
/// becomes a fan around its first corner, unless a triangle of the fan has no area. Throws `Error(Input)` if
/// a vertex is out of range, `Error(Usage)` if there are fewer corners than the sizes add up to.
RAYMAP_API CutPolygons cutPolygons(std::span<const glm::dvec3> positions, std::span<const uint32_t> corners,
                                   std::span<const uint32_t> sizes);

}  // namespace raymap
