#include <raymap/error.h>
#include <raymap/mesh.h>

#include <string>
#include <utility>

#include "mesh/single_origin.h"

namespace raymap {

namespace {

void extend(Box& box, const glm::dvec3& p) {
  box.min = glm::min(box.min, p);
  box.max = glm::max(box.max, p);
}

}  // namespace

Mesh makeMesh(std::span<const glm::dvec3> positions, std::vector<glm::uvec3> triangles) {
  Box box;
  for (const glm::uvec3& triangle : triangles)
    for (int c = 0; c < 3; ++c)
      if (triangle[c] < positions.size()) extend(box, positions[triangle[c]]);
  Mesh mesh;
  mesh.triangles = std::move(triangles);
  mesh.origin = singleOrigin(box, positions.size(), [&](size_t v) { return positions[v]; });
  mesh.vertices.reserve(positions.size());
  for (const glm::dvec3& p : positions) mesh.vertices.push_back(roundedToSingle(p - mesh.origin));
  return mesh;
}

namespace {

void checkFace(const Mesh& mesh, uint32_t face) {
  if (face >= mesh.triangles.size())
    throw Error(ErrorCode::Usage, "there is no face " + std::to_string(face) + ", only " +
                                      std::to_string(mesh.triangles.size()));
}

}  // namespace

void turnFaces(Mesh& mesh, std::span<const uint32_t> faces) {
  for (const uint32_t face : faces) {
    checkFace(mesh, face);
    std::swap(mesh.triangles[face].y, mesh.triangles[face].z);
  }
}

void removeFaces(Mesh& mesh, std::span<const uint32_t> faces) {
  std::vector<bool> isRemoved(mesh.triangles.size());
  for (const uint32_t face : faces) {
    checkFace(mesh, face);
    isRemoved[face] = true;
  }
  size_t kept = 0;
  for (size_t f = 0; f < isRemoved.size(); ++f)
    if (!isRemoved[f]) mesh.triangles[kept++] = mesh.triangles[f];
  mesh.triangles.resize(kept);
}

}  // namespace raymap
