#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace raymap {

/// A corner of a polygon in the plane, with a number of the caller's.
struct FlatCorner {
  glm::dvec2 position;
  uint32_t number;
};

/// Covers a polygon in the plane with triangles that have its corners, and no area of 0. The first loop is
/// counter-clockwise, and the others, holes in it, are clockwise. Appends the triangles' numbers,
/// counter-clockwise. Returns false, and appends nothing, if loops cross or have too many corners: the time
/// may grow with the square of their number.
bool coverPolygon(std::span<const std::vector<FlatCorner>> loops, std::vector<glm::uvec3>& triangles);

}  // namespace raymap
