#pragma once

#include <raymap/field.h>

#include <algorithm>
#include <cmath>

namespace raymap {

/// Throws `Error(Usage)` unless the grid has samples and a positive, finite spacing.
void validateGrid(const Grid& grid);
/// Throws `Error(Usage)` unless the grid is valid and the field has one distance per sample.
void validateField(const Field& field);

/// Interpolates a field between its samples. Positions are in sample coordinates and values in units of the
/// spacing, so that drawing does not depend on the field's scale.
class FieldSampler {
 public:
  explicit FieldSampler(const Field& field)
      : samples_(field.distance.data()),
        last_(field.grid.dims - 1),
        lastCell_(glm::max(field.grid.dims - 2, 0)),
        strideX_(field.grid.dims.x > 1 ? 1 : 0),
        strideY_(field.grid.dims.y > 1 ? size_t(field.grid.dims.x) : 0),
        strideZ_(field.grid.dims.z > 1 ? size_t(field.grid.dims.x) * size_t(field.grid.dims.y) : 0),
        dims_(field.grid.dims),
        scale_(1.0 / field.grid.spacing) {}

  /// Returns the trilinear value inside the grid. Outside it returns a lower bound on the distance to a
  /// surface inside. Let q be the point of the box closest to p. The surface lies at least value(q) from q.
  /// Seen from q, it is never at an acute angle to p, so Pythagoras gives the bound. The sum of both
  /// distances would be too large a step.
  double value(const glm::dvec3& p) const {
    glm::dvec3 q;
    for (int a = 0; a < 3; ++a)
      q[a] = std::max(0.0, std::min(p[a], last_[a]));  // in this order, NaN becomes 0
    const double inGrid = trilinear(q);
    if (q == p) return inGrid;
    return std::hypot(glm::length(p - q), std::max(inGrid, 0.0));
  }

  /// Returns central differences of the value, one sample to each side. They are continuous across cells,
  /// where the gradient of the trilinear value jumps.
  glm::dvec3 gradient(const glm::dvec3& p) const {
    glm::dvec3 g;
    for (int a = 0; a < 3; ++a) {
      glm::dvec3 step(0.0);
      step[a] = 1.0;
      g[a] = 0.5 * (value(p + step) - value(p - step));
    }
    return g;
  }

  const glm::dvec3& last() const { return last_; }

 private:
  double trilinear(const glm::dvec3& q) const {
    const glm::ivec3 cell = glm::min(glm::ivec3(q), lastCell_);
    const glm::dvec3 t = q - glm::dvec3(cell);
    const float* s =
        samples_ + (size_t(cell.z) * size_t(dims_.y) + size_t(cell.y)) * size_t(dims_.x) + cell.x;
    const auto row = [&](const float* at) { return at[0] + t.x * (double(at[strideX_]) - at[0]); };
    const auto sheet = [&](const float* at) {
      const double low = row(at);
      return low + t.y * (row(at + strideY_) - low);
    };
    const double low = sheet(s);
    return scale_ * (low + t.z * (sheet(s + strideZ_) - low));
  }

  const float* samples_;
  glm::dvec3 last_;
  glm::ivec3 lastCell_;
  size_t strideX_, strideY_, strideZ_;  // 0 along an axis of one sample
  glm::ivec3 dims_;
  double scale_;
};

}  // namespace raymap
