#pragma once

#include <glm/glm.hpp>

namespace raymap {

/// Interpolates linearly along x, then y, then z, in the precision of `Real`. `at(x, y, z)` returns the value
/// of a corner, 0 or 1 along each axis.
template <class Real, class At>
Real interpolate(const glm::vec<3, Real>& t, At&& at) {
  const auto alongX = [&](int y, int z) {
    const Real low = at(0, y, z);
    return low + t.x * (at(1, y, z) - low);
  };
  const auto alongY = [&](int z) {
    const Real low = alongX(0, z);
    return low + t.y * (alongX(1, z) - low);
  };
  const Real low = alongY(0);
  return low + t.z * (alongY(1) - low);
}

/// Interpolates the samples of a grid, as `interpolate` does.
template <class Real>
class Trilinear {
 public:
  using Point = glm::vec<3, Real>;

  Trilinear(const glm::ivec3& dims, const float* samples)
      : samples_(samples),
        dims_(dims),
        lastCell_(glm::max(dims - 2, 0)),
        strideX_(dims.x > 1 ? 1 : 0),
        strideY_(dims.y > 1 ? size_t(dims.x) : 0),
        strideZ_(dims.z > 1 ? size_t(dims.x) * size_t(dims.y) : 0) {}

  /// Returns the position of the last sample, in sample coordinates. The first one is at (0, 0, 0).
  Point last() const { return Point(dims_ - 1); }

  /// Returns the value at a point between the outermost samples.
  Real operator()(const Point& p) const {
    const glm::ivec3 cell = glm::min(glm::ivec3(p), lastCell_);
    const float* at =
        samples_ + (size_t(cell.z) * size_t(dims_.y) + size_t(cell.y)) * size_t(dims_.x) + size_t(cell.x);
    return interpolate<Real>(p - Point(cell), [&](int x, int y, int z) {
      return Real(at[size_t(x) * strideX_ + size_t(y) * strideY_ + size_t(z) * strideZ_]);
    });
  }

 private:
  const float* samples_;
  glm::ivec3 dims_;
  glm::ivec3 lastCell_;
  size_t strideX_, strideY_, strideZ_;  // 0 along an axis of one sample
};

}  // namespace raymap
