#include <raymap/error.h>
#include <raymap/mesh.h>

#include <cmath>
#include <string>
#include <utility>

namespace raymap {

namespace {

bool isFinite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::string text(const glm::vec3& v) {
  return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
}

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
  if (!box.isEmpty()) mesh.origin = box.centre();
  mesh.vertices.reserve(positions.size());
  for (const glm::dvec3& p : positions) mesh.vertices.emplace_back(p - mesh.origin);
  return mesh;
}

void turnFaces(Mesh& mesh, std::span<const uint32_t> faces) {
  for (const uint32_t face : faces) {
    if (face >= mesh.triangles.size())
      throw Error(ErrorCode::Usage, "there is no face " + std::to_string(face) + " to turn, only " +
                                        std::to_string(mesh.triangles.size()));
    std::swap(mesh.triangles[face].y, mesh.triangles[face].z);
  }
}

Box bounds(const Mesh& mesh) {
  glm::vec3 low(INFINITY);
  glm::vec3 high(-INFINITY);
  for (const glm::uvec3& triangle : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      low = glm::min(low, mesh.vertices[triangle[c]]);
      high = glm::max(high, mesh.vertices[triangle[c]]);
    }
  return {mesh.origin + glm::dvec3(low), mesh.origin + glm::dvec3(high)};
}

void validate(const Mesh& mesh) {
  if (mesh.triangles.empty()) throw Error(ErrorCode::Input, "the mesh has no triangles");
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      const uint32_t v = mesh.triangles[t][c];
      if (v >= mesh.vertices.size())
        throw Error(ErrorCode::Input, "triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) +
                                          ", but there are only " + std::to_string(mesh.vertices.size()));
      if (!isFinite(mesh.vertices[v]))
        throw Error(ErrorCode::Input, "vertex " + std::to_string(v) + " of triangle " + std::to_string(t) +
                                          " is not finite: " + text(mesh.vertices[v]));
    }
  if (!std::isfinite(mesh.origin.x + mesh.origin.y + mesh.origin.z))
    throw Error(ErrorCode::Input, "the mesh's origin is not finite");
}

}  // namespace raymap
