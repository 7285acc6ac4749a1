#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace raymap {

/// Flips edges between counter-clockwise triangles of the plane where that makes them less thin (Delaunay's
/// criterion). Covers the same area, and keeps the edges that one triangle has.
void flipThinTriangles(std::span<const glm::dvec2> corners, std::vector<glm::uvec3>& triangles);

}  // namespace raymap
