#pragma once

#include <glm/glm.hpp>
#include <span>

#include "mesh/packed_mesh.h"

namespace raymap::cpu {

/// Point of a triangle: the sum of the corners times `weights`.
struct TrianglePoint {
  glm::dvec3 position, weights;
};

/// Returns the point of a triangle that is closest to p. The triangle may be a segment or a point.
TrianglePoint closestPoint(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                           const glm::dvec3& c);

/// Finds the same, to the bit, for each point and the triangle of the mesh in its place. `kNoTriangle` gives
/// NaN. Points are relative to the mesh's origin.
void findClosestPoints(const PackedMesh& mesh, std::span<const glm::dvec3> points,
                       std::span<const uint32_t> triangles, std::span<TrianglePoint> closest);

}  // namespace raymap::cpu
