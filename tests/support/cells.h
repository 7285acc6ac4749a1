#pragma once

// Meshes and values of cells.

#include "base/parallel.h"
#include "testing/cell_meshes.h"  // IWYU pragma: export

namespace raymap {

using namespace cpu;

inline CellLattice unitCells(const CellMesh& mesh) {
  return {mesh.dims, glm::dvec3(0.0), 1.0};
}

/// Returns a mesh whose positions are in cells.
inline OwnCellMesh inCells(const Mesh& mesh, const glm::ivec3& dims = glm::ivec3(20)) {
  return {mesh, Grid{dims, glm::dvec3(0.0), 1.0}};
}

/// Returns 300 triangles of next to no area in 10 x 10 x 10 cells.
inline OwnCellMesh sliversSegmentsAndPoints() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> at(-2.0f, 12.0f);
  OwnCellMesh mesh = cellSoup(300, {10, 10, 10}, 8);
  for (size_t t = 0; t < 300; ++t) {
    const glm::vec3 a = mesh.corner(t, 0), far(at(random), at(random), at(random));
    glm::vec3* v = mesh.vertices.data() + 3 * t;
    v[1] = t % 3 == 0 ? a : far;
    v[2] = t % 3 == 1 ? a + 0.25f * (far - a) : t % 3 == 2 ? 0.5f * (a + far) + 1e-4f : a;
  }
  return mesh;
}

/// Two occupied cells of a line of 2001. The cells up to `last` are nearer to the lower one, or as near.
struct TwoCells {
  uint32_t low, high, last;
  float more = 0.0f;  ///< By how much the higher one has more.

  Buffer<float> squared() const {
    Buffer<float> values = randomCells({2001, 1, 1}, 0.0, 1);
    values[low] = 0.3f;
    values[high] = 0.3f + more;
    return values;
  }
};

/// Returns cells whose border single precision would misplace if it computed squares or reciprocals first.
inline std::vector<TwoCells> closeCells() {
  std::vector<TwoCells> all{{0, 2000, 1000, 0.001f}};
  for (const uint32_t low : {299U, 0U, 98U})
    for (const uint32_t high : {1749U, 98U, 1998U})
      if (high > low) all.push_back({low, high, (low + high) / 2});
  return all;
}

}  // namespace raymap
