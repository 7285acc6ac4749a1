#pragma once

#include <raymap/field.h>

#include <optional>

namespace raymap {

/// Numbers of a cube of 8 x 8 x 8 samples: those of a leaf, or one for all its samples on the lattice.
struct SparseBlock {
  const float* values = nullptr;  ///< Null without a leaf.
  float constant = 0.0f;

  /// Returns the number of a sample of the block.
  float at(const glm::ivec3& sample) const {
    constexpr int kSide = NarrowBand::kLeafSide;
    const glm::ivec3 within = sample & (kSide - 1);
    return values ? values[(within.z * kSide + within.y) * kSide + within.x] : constant;
  }
};

/// Returns the first sample of the block of a sample, which may be negative.
inline glm::ivec3 blockOf(const glm::ivec3& sample) {
  return sample & ~(NarrowBand::kLeafSide - 1);
}

/// Returns the block whose first sample this is.
inline SparseBlock blockAt(const Field& band, const glm::ivec3& low) {
  if (const std::optional<size_t> place = band.narrow->find(low))
    return {band.distance.data() + *place, 0.0f};
  return {nullptr, band.distanceAt(low)};
}

/// Reads samples of the lattice, and remembers the last block, which has the next sample too more often than
/// not. For one thread.
class SparseReader {
 public:
  /// `first` lies in the block of the sample that is read first.
  SparseReader(const Field& band, const glm::ivec3& first)
      : band_(band), low_(blockOf(first)), block_(blockAt(band, low_)) {}

  float operator()(const glm::ivec3& sample) { return blockWith(sample).at(sample); }

  /// Returns the block of a sample.
  const SparseBlock& blockWith(const glm::ivec3& sample) {
    if (const glm::ivec3 low = blockOf(sample); low != low_) {
      low_ = low;
      block_ = blockAt(band_, low);
    }
    return block_;
  }

 private:
  const Field& band_;
  glm::ivec3 low_;
  SparseBlock block_;
};

}  // namespace raymap
