#pragma once

// Cuts one polygon into triangles.

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace raymap {

/// Result of cutting a polygon.
enum class PolygonCut {
  Fan,    ///< A fan around its first corner, which covers it.
  Swept,  ///< Other triangles that cover it.
  None    ///< A fan that does not cover it: it crosses itself, or all its corners lie on a line.
};

/// Appends the triangles of a polygon, as numbers of its corners. They turn the way that the polygon does.
///
/// A polygon becomes a fan if the fan covers it without overlap, and only repeated corners have triangles
/// without area. That is so for convex polygons without corners within their edges. The rest are cut in the
/// plane of their area vector. Corners may repeat, and edges may touch or run back along each other, as
/// bridges to holes do. Corners that are not finite make a fan.
PolygonCut cutPolygon(std::span<const glm::dvec3> corners, std::vector<glm::uvec3>& triangles);

}  // namespace raymap
