#pragma once

#include <span>
#include <vector>

#include "base/progress.h"
#include "method/cell_mesh.h"

namespace raymap {

/// The number of a cube of samples; see `cubeAround`.
inline uint64_t cubeIndex(const glm::ivec3& cube, const glm::ivec3& dims) {
  return (uint64_t(cube.z) * uint64_t(dims.y + 1) + uint64_t(cube.y)) * uint64_t(dims.x + 1) +
         uint64_t(cube.x);
}

/// A part of the mesh's rims: their middle, and how long they are.
struct RimPart {
  glm::dvec3 middle{0.0};
  double length = 0.0;
};

/// Bytes that `findRims` may hold for each triangle of the mesh.
inline constexpr size_t kRimBytesPerTriangle = 2 * 3 * 2 * sizeof(glm::vec3);

/// What of the mesh's rims, the edges with an odd number of triangles, lies in each of `cubes`, which ascend.
std::vector<RimPart> findRims(const CellMesh& mesh, std::span<const uint64_t> cubes, Progress& progress);

}  // namespace raymap
