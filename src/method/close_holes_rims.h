#pragma once

#include <span>
#include <vector>

#include "base/progress.h"
#include "method/cell_mesh.h"

namespace raymap {

/// Returns the index of a cube of samples; see `cubeAround`.
inline uint64_t cubeIndex(const glm::ivec3& cube, const glm::ivec3& dims) {
  return (uint64_t(cube.z) * uint64_t(dims.y + 1) + uint64_t(cube.y)) * uint64_t(dims.x + 1) +
         uint64_t(cube.x);
}

/// Part of the mesh's rims, in cell units.
struct RimPart {
  glm::dvec3 middle{0.0};
  double length = 0.0;  ///< 0 if there is no rim.
};

/// Upper bound on the bytes that `findRims` holds for each triangle of the mesh.
inline constexpr size_t kRimBytesPerTriangle = 2 * 3 * 2 * sizeof(glm::vec3);

/// Returns the part of the mesh's rims in each of `cubes`, which must ascend. Rims are the edges with an odd
/// number of triangles.
std::vector<RimPart> findRims(const CellMesh& mesh, std::span<const uint64_t> cubes, Progress& progress);

}  // namespace raymap
