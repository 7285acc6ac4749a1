#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "field/empty_space.h"
#include "field/field_sampler.h"
#include "field/leaf_tree.h"

namespace raymap {

/// A field to draw: a dense one or a narrow band, to which it keeps a reference. Positions are in sample
/// coordinates and values in units of the spacing, as in `Sampler`.
class DrawnField {
 public:
  DrawnField(const Field& field);  // NOLINT(google-explicit-constructor): A scene is made of a field.
  /// A narrow band of these widths whose samples are on a device; the field has its grid, and no samples.
  DrawnField(const Field& elsewhere, double inside, double outside);
  DrawnField(Field&&) = delete;

  /// A stretch of a ray along which the field has one value.
  struct Plateau {
    double value;
    double length;
  };

  /// A value between samples. Where some are clamped, the distance may lie beyond it.
  struct Reading {
    double value;
    bool mayBeLess;  ///< A sample is clamped inside.
    bool mayBeMore;  ///< A sample is clamped outside, or the point lies outside of the grid.
  };

  const Field& field() const { return *field_; }
  /// Returns the tree of the narrow band, or null for a dense field.
  const LeafTree* tree() const { return tree_.get(); }
  /// Returns the number of words that `leafIndex` returns.
  size_t leafIndexCount() const;
  /// Returns the words by which shaders find the leaves of a narrow band (picture/drawn_field_shared.h).
  /// Distances of samples in no leaf are multiplied by `scale`.
  std::vector<uint32_t> leafIndex(double scale) const;
  /// Returns the number of samples that the host or a device holds; 0 if that is not known.
  size_t sampleCount() const {
    if (isBandElsewhere_) return 0;
    return tree_ ? field_->distance.size() : grid().sampleCount();
  }
  const Grid& grid() const { return field_->grid; }
  /// Returns whether the samples are in the host's memory.
  bool hasSamples() const { return tree_ || !field_->distance.empty(); }
  /// Returns the position of the last sample.
  glm::dvec3 last() const { return glm::dvec3(grid().dims - 1); }
  /// Distances are clamped to these, in the mesh's units; infinite if they are not.
  double inside() const { return inside_; }
  double outside() const { return outside_; }

  double value(const glm::dvec3& p) const { return whole_ ? whole_->value(p) : sparse_->value(p); }
  glm::dvec3 gradient(const glm::dvec3& p) const {
    return whole_ ? whole_->gradient(p) : sparse_->gradient(p);
  }
  /// Returns a value as `value` does, and whether the samples around the point are clamped.
  Reading reading(const glm::dvec3& p) const;
  /// Returns the plateau on which a ray goes on from a point, if samples without leaves surround the point.
  std::optional<Plateau> plateau(const glm::dvec3& p, const glm::dvec3& direction) const;

 private:
  /// Reads a band through its tree.
  struct TreeReader {
    SparseBlock blockWith(const glm::ivec3& sample) const { return tree->blockWith(sample); }
    const LeafTree* tree;
  };
  using SparseSampler = Sampler<SparseTrilinear<TreeReader>>;

  const Field* field_;
  bool isBandElsewhere_ = false;
  double inside_, outside_;
  std::unique_ptr<const LeafTree> tree_;
  std::optional<EmptySpace> space_;
  std::optional<FieldSampler> whole_;
  std::optional<SparseSampler> sparse_;
};

}  // namespace raymap
