#pragma once

#include <raymap/picture.h>

#include <variant>

#include "picture/colouring.h"
#include "picture/drawn_field.h"

namespace raymap {

/// Numbers in colour on slice, cut face and surface.
class ShownNumbers {
 public:
  /// Keeps references to the fields. Shows what the options say: an array, or the difference of two fields.
  /// Throws `Error(Usage)` for the difference of a dense field from a band.
  ShownNumbers(const DrawnField& field, const RenderOptions& options);

  /// Returns the number at a point in sample coordinates, NaN where it is not known; differences are in
  /// samples.
  double at(const glm::dvec3& p) const;
  const Colouring& colouring() const { return colouring_; }
  /// Returns the winding numbers, confidences, or distances of the second field. None are there of the
  /// difference from a narrow band.
  const Buffer<float>& numbers() const {
    const OfLeaves* leaves = std::get_if<OfLeaves>(&source_);
    return leaves ? leaves->numbers : std::get<OfDense>(source_).numbers;
  }
  bool isDifference() const { return isDifference_; }

 private:
  /// An array of a dense field, or the difference of two on one grid.
  struct OfDense {
    double operator()(const glm::dvec3& p) const { return scale * (between(p) - (base ? (*base)(p) : 0.0)); }
    const Buffer<float>& numbers;
    Trilinear<double> between;
    std::optional<Trilinear<double>> base;
    double scale;
  };
  /// An array of a narrow band.
  struct OfLeaves {
    double operator()(const glm::dvec3& p) const { return SparseTrilinear(between)(p); }
    struct Reader {
      SparseBlock blockWith(const glm::ivec3& sample) const { return tree->blockWith(sample, *numbers); }
      const LeafTree* tree;
      const Buffer<float>* numbers;
    };
    const Buffer<float>& numbers;
    SparseTrilinear<Reader> between;
  };
  /// The difference of a field from a narrow band. Clamped distances bound it: it is known all the same
  /// where the bound is in the deepest colour.
  struct OfBand {
    double operator()(const glm::dvec3& p) const;
    const DrawnField* first;
    DrawnField other;
    double scale;      ///< Spacing of the first field's grid, in samples of the other's.
    glm::dvec3 shift;  ///< Position of the first field's first sample, in samples of the other's.
    double range;      ///< The least difference in the deepest colour.
  };
  using Source = std::variant<OfDense, OfLeaves, OfBand>;

  static Source sourceOf(const DrawnField& field, const RenderOptions& options);

  bool isDifference_;
  Colouring colouring_;
  glm::dvec3 last_;
  Source source_;
};

}  // namespace raymap
