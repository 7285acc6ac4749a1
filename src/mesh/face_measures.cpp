#include "mesh/face_measures.h"

#include "mesh/triangle.h"

namespace raymap {

namespace {

constexpr double kDegenerateHeight = 1e-6;  // Share of the longest edge.

}  // namespace

bool isFlat(const std::array<glm::dvec3, 3>& corners) {
  double longest2 = 0.0;
  for (size_t c = 0; c < 3; ++c) {
    const glm::dvec3 edge = corners[c] - corners[(c + 1) % 3];
    longest2 = std::max(longest2, glm::dot(edge, edge));
  }
  // The height over the longest edge is twice the area over that edge's length.
  return glm::length(doubleAreaNormal(corners[0], corners[1], corners[2])) < kDegenerateHeight * longest2;
}

FaceMeasure measureFace(const PackedMesh& mesh, const Welding& welding, size_t f, const glm::dvec3& centre) {
  if (hasRepeatedCorner(weldedFace(mesh, welding, f))) return {.isDegenerate = true};
  const std::array<glm::dvec3, 3> corners = mesh.corners(mesh.triangles[f]);
  const glm::dvec3 normal = doubleAreaNormal(corners[0], corners[1], corners[2]);
  return {.area = glm::length(normal) / 2.0,
          .volume = glm::dot(corners[0] - centre, normal) / 6.0,
          .isDegenerate = isFlat(corners),
          .isSurface = true};
}

}  // namespace raymap
