#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace raymap {

/// Cuts a counter-clockwise polygon of the plane into triangles that do not overlap, and appends them as
/// numbers of its corners. Returns false, and appends nothing, if the polygon crosses itself.
///
/// A corner that lies within `tolerance` of an edge is taken to lie on it. The edge is then split there, and
/// a triangle without area keeps the whole edge in the result.
bool sweepPolygon(std::span<const glm::dvec2> corners, double tolerance, std::vector<glm::uvec3>& triangles);

}  // namespace raymap
