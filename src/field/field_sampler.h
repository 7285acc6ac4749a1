#pragma once

#include <raymap/narrow_band.h>
#include <raymap/sample.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

#include "field/sparse_reader.h"
#include "field/trilinear.h"

namespace raymap {

/// Returns what is wrong with the place of a grid, or an empty text: spacing and origin must be finite, the
/// spacing positive and of full precision, and no coordinate beyond single precision, as distances could not.
std::string placeProblem(const Grid& grid);
/// Throws `Error(Usage)` unless the grid has samples and no problem with its place.
void validateGrid(const Grid& grid);
/// Throws `Error(Usage)` unless the grid is valid and the field has one distance per sample, or of a narrow
/// band 512 of each array per leaf. Does not look at the leaves.
void validateField(const Field& field);
/// Throws `Error(Usage)` unless the grid is valid and the field has one value of this array per sample, or is
/// a narrow band with this array for which `validate` throws nothing.
void validateArray(const Field& field, FieldArray array);
// Throw `Error(Usage)` for a field of the other kind.
void requireDense(const Field& field);
void requireNarrow(const Field& field);
/// Returns an array of numbers: any but the triangles.
inline const Buffer<float>& numbersOf(const Field& field, FieldArray array) {
  return array == FieldArray::Winding      ? field.winding
         : array == FieldArray::Confidence ? field.confidence
                                           : field.distance;
}

/// Computes the distances and the gradients at all points; null = not wanted. See raymap/sample.h. Throws
/// `Error(Usage)` as `validateField` does.
void sampleInto(const Field& field, std::span<const glm::dvec3> points, Outside outside, float* distance,
                glm::vec3* gradient);

/// Interpolates the samples of a narrow band, as `Trilinear` those of a dense field. `Reader` finds blocks.
/// For one thread.
template <class Reader>
class SparseTrilinear {
 public:
  SparseTrilinear(const glm::ivec3& dims, const Reader& read) : last_(dims - 1), read_(read) {}

  glm::dvec3 last() const { return glm::dvec3(last_); }

  double operator()(const glm::dvec3& p) {
    const glm::ivec3 cell = glm::min(glm::ivec3(p), glm::max(last_ - 1, 0));
    const std::array<double, 8> corners = cornersOf(cell);
    return interpolate<double>(p - glm::dvec3(cell),
                               [&](int x, int y, int z) { return corners[x + 2 * y + 4 * z]; });
  }

 private:
  /// Returns the samples around a point, and looks up each block that has some of them once.
  std::array<double, 8> cornersOf(const glm::ivec3& cell) {
    const glm::bvec3 isApart = glm::notEqual(blockOf(cell), blockOf(cell + 1));
    const int apart = (isApart.x ? 1 : 0) + (isApart.y ? 2 : 0) + (isApart.z ? 4 : 0);
    std::array<SparseBlock, 8> blocks;
    std::array<double, 8> corners;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 sample = glm::min(cell + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2), last_);
      const int block = corner & apart;  // The first corner that has the same block.
      if (block == corner) blocks[block] = read_.blockWith(sample);
      corners[corner] = double(blocks[block].at(sample));
    }
    return corners;
  }

  glm::ivec3 last_;
  Reader read_;
};

/// Interpolates a field between its samples, by `Between`. Positions are in sample coordinates and values in
/// units of the spacing, so that drawing does not depend on the field's scale.
template <class Between>
class Sampler {
 public:
  Sampler(const Between& between, double spacing)
      : between_(between), last_(between_.last()), scale_(1.0 / spacing) {}

  /// Returns the trilinear value inside the grid. Outside, where a picture shows nothing, it returns a lower
  /// bound on the distance to a surface inside, but for the interpolation's error. Let q be the point of the
  /// box closest to p. The surface lies at least value(q) from q. Seen from q, it is never at an acute angle
  /// to p, so Pythagoras gives the bound. The sum of both distances would be too large a step.
  double value(const glm::dvec3& p) const {
    Between between = between_;
    return value(p, between);
  }

  /// Returns central differences of the value, one sample to each side. They are continuous across cells,
  /// where the gradient of the trilinear value jumps.
  glm::dvec3 gradient(const glm::dvec3& p) const {
    Between between = between_;
    glm::dvec3 g;
    for (int a = 0; a < 3; ++a) {
      glm::dvec3 step(0.0);
      step[a] = 1.0;
      g[a] = 0.5 * (value(p + step, between) - value(p - step, between));
    }
    return g;
  }

  const glm::dvec3& last() const { return last_; }

 private:
  double value(const glm::dvec3& p, Between& between) const {
    glm::dvec3 q;
    for (int a = 0; a < 3; ++a)
      q[a] = std::max(0.0, std::min(p[a], last_[a]));  // in this order, NaN becomes 0
    const double inGrid = scale_ * between(q);
    if (q == p) return inGrid;
    return std::hypot(glm::length(p - q), std::max(inGrid, 0.0));
  }

  Between between_;  // Copied for each point, because a narrow band's remembers a block.
  glm::dvec3 last_;
  double scale_;
};

class FieldSampler : public Sampler<Trilinear<double>> {
 public:
  explicit FieldSampler(const Field& field)
      : Sampler({field.grid.dims, field.distance.data()}, field.grid.spacing) {}
};

class SparseSampler : public Sampler<SparseTrilinear<SparseReader>> {
 public:
  explicit SparseSampler(const Field& band)
      : Sampler({band.grid.dims, SparseReader(band, glm::ivec3(0))}, band.grid.spacing) {}
};

}  // namespace raymap
