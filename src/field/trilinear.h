#pragma once

#include <glm/glm.hpp>

namespace raymap {

/// Interpolates the samples of a grid linearly along x, then y, then z, in the precision of `Real`.
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
    const Point t = p - Point(cell);
    const float* at =
        samples_ + (size_t(cell.z) * size_t(dims_.y) + size_t(cell.y)) * size_t(dims_.x) + size_t(cell.x);
    const auto alongX = [&](const float* row) {
      return Real(row[0]) + t.x * (Real(row[strideX_]) - Real(row[0]));
    };
    const auto alongY = [&](const float* sheet) {
      const Real low = alongX(sheet);
      return low + t.y * (alongX(sheet + strideY_) - low);
    };
    const Real low = alongY(at);
    return low + t.z * (alongY(at + strideZ_) - low);
  }

 private:
  const float* samples_;
  glm::ivec3 dims_;
  glm::ivec3 lastCell_;
  size_t strideX_, strideY_, strideZ_;  // 0 along an axis of one sample
};

}  // namespace raymap
