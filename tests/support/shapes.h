#pragma once

// The meshes that the self-test of a GPU makes, too, and what only tests do with them.

#include <glm/gtc/matrix_transform.hpp>

#include "mesh/shapes.h"  // IWYU pragma: export

namespace raymap::shapes {

/// Turns about an odd axis, so that nothing lies along the axes or a grid.
inline const glm::dmat3 kTurn(glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1.0, 2.0, 3.0))));

inline Mesh rotated(const Mesh& mesh) {
  std::vector<glm::dvec3> p;
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) p.push_back(kTurn * mesh.position(v));
  return makeMesh(p, mesh.triangles);
}

/// Returns a mesh whose faces point to the other side.
inline Mesh inverted(Mesh mesh) {
  for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

}  // namespace raymap::shapes
