#pragma once

#include <raymap/narrow_band.h>

#include <optional>

#include "field/leaf_tree.h"

namespace raymap {

/// Finds the places of samples among the distances of a field, dense or a narrow band. Takes a dense field as
/// one leaf. For one thread.
class SamplePlaces {
 public:
  /// Keeps a reference to the field. Its distances may change, its leaves may not.
  explicit SamplePlaces(const Field& field)
      : field_(field),
        leaf_{.dims = field.narrow ? glm::ivec3(NarrowBand::kLeafSide) : field.grid.dims},
        low_(field.narrow ? kMostDims : 0) {
    if (field.narrow) tree_.emplace(field);
  }

  /// Returns the sample at a place.
  glm::ivec3 at(size_t place) const {
    const size_t x = size_t(leaf_.dims.x), y = size_t(leaf_.dims.y), z = size_t(leaf_.dims.z);
    const glm::ivec3 within(place % x, place / x % y, place / (x * y) % z);
    return field_.narrow ? field_.narrow->leaves[place / (x * y * z)] + within : within;
  }

  /// Returns the place of a sample, or what `LeafTree::find` says. Remembers its leaf.
  int64_t find(const glm::ivec3& sample) {
    const auto has = [](const Grid& grid, const glm::ivec3& s) {
      return glm::all(glm::lessThan(glm::uvec3(s), glm::uvec3(grid.dims)));  // Negative ones are large.
    };
    if (has(leaf_, sample - low_)) return first_ + int64_t(leaf_.index(sample - low_));
    const int64_t place = has(field_.grid, sample) ? tree_->find(sample) : LeafTree::kOutside;
    if (place >= 0) low_ = blockOf(sample), first_ = place - int64_t(leaf_.index(sample - low_));
    return place;
  }

 private:
  const Field& field_;
  std::optional<LeafTree> tree_;
  Grid leaf_;
  glm::ivec3 low_;     // First sample of the last leaf.
  int64_t first_ = 0;  // Its place.
};

}  // namespace raymap
