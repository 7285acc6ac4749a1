#pragma once

#include <raymap/mesh_view.h>

#include <array>
#include <span>

namespace raymap {

/// A mesh whose arrays lie tightly packed as in `Mesh`: the form that all stages read. Refers to the arrays.
struct PackedMesh {
  PackedMesh() = default;
  PackedMesh(const Mesh& mesh) : vertices(mesh.vertices), triangles(mesh.triangles), origin(mesh.origin) {}
  PackedMesh(std::span<const glm::vec3> positions, std::span<const glm::uvec3> faces, const glm::dvec3& about)
      : vertices(positions), triangles(faces), origin(about) {}

  std::span<const glm::vec3> vertices;
  std::span<const glm::uvec3> triangles;
  glm::dvec3 origin{0.0};

  operator MeshView() const { return {vertices, triangles, origin}; }
  glm::dvec3 position(uint32_t vertex) const { return origin + glm::dvec3(vertices[vertex]); }
  /// Returns the corners of a face, relative to the origin.
  std::array<glm::dvec3, 3> corners(const glm::uvec3& face) const {
    return {glm::dvec3(vertices[face.x]), glm::dvec3(vertices[face.y]), glm::dvec3(vertices[face.z])};
  }
};

}  // namespace raymap
