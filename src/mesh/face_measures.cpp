#include "mesh/face_measures.h"

namespace raymap {

namespace {

constexpr double kDegenerateHeight = 1e-6;  // Share of the longest edge.

bool hasRepeatedCorner(const glm::uvec3& face) {
  return face.x == face.y || face.y == face.z || face.z == face.x;
}

glm::dvec3 normalOf(const PackedMesh& mesh, const glm::uvec3& face) {
  const glm::dvec3 a(mesh.vertices[face.x]);
  return glm::cross(glm::dvec3(mesh.vertices[face.y]) - a, glm::dvec3(mesh.vertices[face.z]) - a);
}

/// Returns whether the triangle's height is below `kDegenerateHeight`. The height over the longest edge is
/// twice the area over that edge's length.
bool isFlat(const PackedMesh& mesh, const glm::uvec3& face, double doubleArea) {
  double longest2 = 0.0;
  for (int c = 0; c < 3; ++c) {
    const glm::dvec3 edge = glm::dvec3(mesh.vertices[face[c]]) - glm::dvec3(mesh.vertices[face[(c + 1) % 3]]);
    longest2 = std::max(longest2, glm::dot(edge, edge));
  }
  return doubleArea < kDegenerateHeight * longest2;
}

}  // namespace

FaceMeasure measureFace(const PackedMesh& mesh, const Welding& welding, size_t f, const glm::dvec3& centre) {
  if (hasRepeatedCorner(weldedFace(mesh, welding, f))) return {.isDegenerate = true};
  const glm::uvec3& face = mesh.triangles[f];
  const glm::dvec3 normal = normalOf(mesh, face);
  const double doubleArea = glm::length(normal);
  return {.area = doubleArea / 2.0,
          .volume = glm::dot(glm::dvec3(mesh.vertices[face.x]) - centre, normal) / 6.0,
          .isDegenerate = isFlat(mesh, face, doubleArea),
          .isSurface = true};
}

}  // namespace raymap
