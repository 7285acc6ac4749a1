// Krayer & Müller 2019, §4, end: finds where the sign changes without a triangle. The surface that closes
// these holes is made in method/close_holes_patch.cpp.

#include "cpu/sign/close_holes.h"

#include <cmath>

#include "base/parallel.h"

namespace raymap::cpu {

namespace {

/// Signs of all samples, and the lattice edges that triangles cross.
class SignLattice {
 public:
  SignLattice(const RayMap& map, const Buffer<float>& winding, double threshold)
      : map_(map), winding_(winding), threshold_(static_cast<float>(threshold)) {}

  float winding(size_t s) const { return winding_[s]; }
  bool isInside(size_t s) const { return std::abs(winding_[s]) > threshold_; }
  const glm::ivec3& dims() const { return map_.dims; }
  size_t index(const glm::ivec3& s) const {
    return (size_t(s.z) * size_t(dims().y) + size_t(s.y)) * size_t(dims().x) + size_t(s.x);
  }
  bool isCrossed(int axis, const glm::ivec3& sample) const {
    glm::ivec3 next = sample;
    ++next[axis];
    return map_.unsignedRay(axis, sample) != map_.unsignedRay(axis, next);
  }
  /// Returns whether triangles cross an edge of the cube at which the sign changes. Returns false for a cube
  /// that reaches beyond the grid.
  bool hasCrossedChange(const glm::ivec3& cube) const;

 private:
  const RayMap& map_;
  const Buffer<float>& winding_;
  float threshold_;
};

bool SignLattice::hasCrossedChange(const glm::ivec3& cube) const {
  if (glm::any(glm::equal(cube, glm::ivec3(0))) || glm::any(glm::equal(cube, dims()))) return false;
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner) {
      glm::ivec3 low = cube - 1;
      low[(axis + 1) % 3] += corner & 1;
      low[(axis + 2) % 3] += corner >> 1;
      glm::ivec3 high = low;
      ++high[axis];
      if (isInside(index(low)) != isInside(index(high)) && isCrossed(axis, low)) return true;
    }
  return false;
}

void findAlongRow(const SignLattice& lattice, int j, int k, std::vector<MissingEdge>& edges) {
  const glm::ivec3& dims = lattice.dims();
  const size_t first = lattice.index({0, j, k});
  const size_t steps[] = {1, size_t(dims.x), size_t(dims.x) * size_t(dims.y)};
  for (int i = 0; i < dims.x; ++i) {
    const glm::ivec3 sample(i, j, k);
    const size_t s = first + size_t(i);
    const bool isInside = lattice.isInside(s);
    for (int axis = 0; axis < 3; ++axis) {
      if (sample[axis] + 1 == dims[axis] || lattice.isInside(s + steps[axis]) == isInside) continue;
      if (lattice.isCrossed(axis, sample)) continue;
      unsigned rimCubes = 0;
      for (uint32_t c = 0; c < kCubesAround; ++c)
        rimCubes |= lattice.hasCrossedChange(cubeAround(sample, axis, int(c))) ? 1u << c : 0u;
      edges.push_back(
          {uint32_t(s), uint32_t(axis), rimCubes, {lattice.winding(s), lattice.winding(s + steps[axis])}});
    }
  }
}

}  // namespace

std::vector<MissingEdge> findMissingEdges(const RayMap& map, const Buffer<float>& winding, double threshold,
                                          Progress& progress) {
  const SignLattice lattice(map, winding, threshold);
  std::vector<std::vector<MissingEdge>> planes(size_t(map.dims.z));
  parallelFor(planes.size(), 1, [&](size_t k, size_t) {
    progress.poll();
    for (int j = 0; j < map.dims.y; ++j) findAlongRow(lattice, j, int(k), planes[k]);
  });
  std::vector<MissingEdge> edges;
  for (const std::vector<MissingEdge>& plane : planes) edges.insert(edges.end(), plane.begin(), plane.end());
  return edges;
}

}  // namespace raymap::cpu
