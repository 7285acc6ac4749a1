#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace raymap {

/// An axis-aligned box in the mesh's own units. Empty until something is added.
struct Box {
  glm::dvec3 min{INFINITY};
  glm::dvec3 max{-INFINITY};

  glm::dvec3 size() const { return max - min; }
  glm::dvec3 centre() const { return 0.5 * (min + max); }
  bool isEmpty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
};

/// An indexed triangle mesh. The position of vertex v is `origin + vertices[v]`, in the mesh's own units.
///
/// Vertices are single precision about a double-precision origin, so that a small mesh far from (0,0,0)
/// loses nothing. Faces are counter-clockwise seen from outside. Holes, crossings, duplicates, flipped and
/// degenerate faces are all valid; a non-finite vertex or an index out of range is not (see `validate`).
struct Mesh {
  std::vector<glm::vec3> vertices;
  std::vector<glm::uvec3> triangles;
  glm::dvec3 origin{0.0};

  glm::dvec3 position(uint32_t vertex) const { return origin + glm::dvec3(vertices[vertex]); }
};

/// A mesh from double-precision positions: centred on its bounds, then rounded to single precision.
Mesh makeMesh(std::span<const glm::dvec3> positions, std::vector<glm::uvec3> triangles);

/// Takes faces the other way round, such as `Stats::turnedFaces`. Throws `Error(Usage)` for one that there is
/// not.
void turnFaces(Mesh& mesh, std::span<const uint32_t> faces);

/// The bounds of the vertices that triangles use.
Box bounds(const Mesh& mesh);

/// Throws `Error(Input)` that names the element and the value if the mesh has no triangle, a non-finite
/// vertex or an index out of range.
void validate(const Mesh& mesh);

}  // namespace raymap
