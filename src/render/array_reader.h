#pragma once

#include "field/field_sampler.h"
#include "field/leaf_tree.h"

namespace raymap {

/// Reads the samples of an array of a dense field, to which it keeps a reference.
class DenseArray {
 public:
  /// Throws `Error(Usage)` if the field has no such array.
  DenseArray(const Field& field, FieldArray kind)
      : field_((validateArray(field, kind), field)), kind_(kind), numbers_(numbersOf(field, kind)) {}

  const Grid& grid() const { return field_.grid; }
  FieldArray kind() const { return kind_; }
  /// Returns the magnitude to which distances are clamped; 0 if they are not.
  double clampDistance() const { return field_.clampDistance; }
  float operator()(const glm::ivec3& sample) const { return numbers_[grid().index(sample)]; }
  uint32_t triangle(const glm::ivec3& sample) const { return field_.triangle[grid().index(sample)]; }

 private:
  const Field& field_;
  FieldArray kind_;
  const Buffer<float>& numbers_;
};

/// Reads the samples of an array of a narrow band, to which it keeps a reference. In no leaf, numbers other
/// than distances are NaN, and there is no triangle.
class BandArray {
 public:
  /// Throws `Error(Usage)` if the band has no such array.
  BandArray(const Field& band, FieldArray kind)
      : tree_((validateArray(band, kind), band)), kind_(kind), numbers_(numbersOf(band, kind)) {}

  const Grid& grid() const { return tree_.band().grid; }
  FieldArray kind() const { return kind_; }
  double clampDistance() const { return tree_.band().clamp(); }
  float operator()(const glm::ivec3& sample) const {
    return (kind_ == FieldArray::Distance ? tree_.blockWith(sample) : tree_.blockWith(sample, numbers_))
        .at(sample);
  }
  uint32_t triangle(const glm::ivec3& sample) const {
    const int64_t place = tree_.find(sample);
    return place < 0 ? kNoTriangle : tree_.band().triangle[size_t(place)];
  }
  /// Returns how many samples the side of a cube without leaves has that holds a sample; 0 if a leaf does.
  int32_t emptySide(const glm::ivec3& sample) const {
    const auto cube = tree_.emptyCube(sample);
    return cube ? cube->side : 0;
  }

 private:
  LeafTree tree_;
  FieldArray kind_;
  const Buffer<float>& numbers_;
};

}  // namespace raymap
