#pragma once

#include <raymap/export.h>

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace raymap {

// Arrays of these types are three numbers after each other, without gaps. A program that makes glm pad them
// (GLM_FORCE_DEFAULT_ALIGNED_GENTYPES) cannot use raymap.
static_assert(sizeof(glm::vec3) == 12 && alignof(glm::vec3) == 4);
static_assert(sizeof(glm::uvec3) == 12 && alignof(glm::uvec3) == 4);
static_assert(sizeof(glm::ivec3) == 12 && alignof(glm::ivec3) == 4);
static_assert(sizeof(glm::dvec3) == 24 && alignof(glm::dvec3) == alignof(double));

/// Types of the numbers in arrays that views refer to.
enum class Scalar : uint8_t { Float, Double };
static_assert(sizeof(glm::vec<3, uint64_t>) == 24 && alignof(glm::vec<3, uint64_t>) == alignof(uint64_t));

/// An axis-aligned box in the mesh's units. Empty until something is added.
struct Box {
  glm::dvec3 min{HUGE_VAL};
  glm::dvec3 max{-HUGE_VAL};

  glm::dvec3 size() const { return max - min; }
  glm::dvec3 centre() const { return 0.5 * (min + max); }
  bool isEmpty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  bool operator==(const Box&) const = default;
};

/// The plane of all points p with dot(normal, p) = offset, in the mesh's units.
struct Plane {
  glm::dvec3 normal{0.0, 0.0, 1.0};  ///< Normal of any length but zero.
  double offset = 0.0;
  bool operator==(const Plane&) const = default;
};

/// An indexed triangle mesh. The position of vertex v is `origin + vertices[v]`, in the mesh's units.
///
/// Vertices are single precision about a double-precision origin, so that a small mesh far from (0,0,0)
/// loses no precision. Faces are counter-clockwise seen from outside. Holes, crossings, duplicate, flipped
/// and degenerate faces are valid input. Vertices that are not finite and indices out of range are not; see
/// `validate` in mesh_view.h.
struct Mesh {
  std::vector<glm::vec3> vertices = {};
  std::vector<glm::uvec3> triangles = {};
  glm::dvec3 origin{0.0};

  glm::dvec3 position(uint32_t vertex) const { return origin + glm::dvec3(vertices[vertex]); }
};

/// Makes a mesh from double-precision positions, rounded to single precision about an origin. This one loses
/// least: about the centre, rounded to few bits, or about 0 positions that are floats or few bits keep all.
RAYMAP_API Mesh makeMesh(std::span<const glm::dvec3> positions, std::vector<glm::uvec3> triangles);

/// Reverses the winding order of these faces, for example of `Stats::turnedFaces`. Throws `Error(Usage)` if
/// an index is out of range.
RAYMAP_API void turnFaces(Mesh& mesh, std::span<const uint32_t> faces);

/// Removes these faces, for example those of `Stats::leftOutFaces`; the others keep their order. Throws
/// `Error(Usage)` if an index is out of range. Turn faces first: removing some changes the others' indices.
RAYMAP_API void removeFaces(Mesh& mesh, std::span<const uint32_t> faces);

}  // namespace raymap
