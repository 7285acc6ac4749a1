#pragma once

// The paper's future work: rays along all 13 directions of the lattice instead of its three axes.
// docs/signs.md explains why raymap does not use them; this code repeats the measurement.

#include "testing/sign_scene.h"

#include <vector>

namespace raymap::bench {

inline constexpr glm::ivec3 kDiagonals[] = {{1, 1, 0},  {1, -1, 0}, {1, 0, 1},  {1, 0, -1}, {0, 1, 1},
                                            {0, 1, -1}, {1, 1, 1},  {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};

/// Adds the counts of both rays of each sample along a diagonal. A shear by whole cells, which keeps volumes,
/// maps the diagonal to the axis of its first component.
inline void addDiagonalRays(const CellMesh& mesh, const glm::ivec3& diagonal, std::vector<double>& sums) {
  const int axis = diagonal.x != 0 ? 0 : 1;
  const glm::ivec3 across = diagonal * glm::ivec3(0, axis == 0, 1);
  // Keeps every sample's coordinates from being negative.
  const glm::ivec3 shift = glm::max(across, 0) * (mesh.dims[axis] - 1);
  CellMesh sheared;
  sheared.dims = mesh.dims + glm::abs(across) * (mesh.dims[axis] - 1);
  sheared.triangles = mesh.triangles;
  sheared.vertices.resizeUninitialized(mesh.vertices.size());
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    sheared.vertices[v] = mesh.vertices[v] + glm::vec3(shift) - glm::vec3(across) * mesh.vertices[v][axis];

  Progress progress;
  Crossings crossings;
  countCrossings(sheared, progress, crossings);
  RayMap map;
  buildRayMap(sheared.dims, crossings, map);
  const LineAxes lines(axis);
  size_t s = 0;
  for (int k = 0; k < mesh.dims.z; ++k)
    for (int j = 0; j < mesh.dims.y; ++j)
      for (int i = 0; i < mesh.dims.x; ++i, ++s) {
        const glm::ivec3 sample(i, j, k), at = sample + shift - across * sample[axis];
        const size_t line = size_t(at[lines.v]) * size_t(sheared.dims[lines.u]) + size_t(at[lines.u]);
        sums[s] += 2.0 * map.ray(axis, at) - map.total(axis, line);
      }
}

/// Returns the mean of all 26 rays, given the mean of the six along the axes.
inline std::vector<double> averageAllRays(const Mesh& mesh, const Grid& grid, const Buffer<float>& sixRays) {
  constexpr double kSix = 6.0, kAll = 26.0;
  std::vector<double> sums(sixRays.begin(), sixRays.end());
  for (double& sum : sums) sum *= kSix;
  const CellMesh cells = cellMesh(mesh, grid);
  for (const glm::ivec3& diagonal : kDiagonals) addDiagonalRays(cells, diagonal, sums);
  for (double& sum : sums) sum /= kAll;
  return sums;
}

}  // namespace raymap::bench
