#pragma once

#include <raymap/narrow_band.h>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "field/sparse_reader.h"

namespace raymap {

/// A tree over the leaves and tiles of a narrow band. It finds what holds a sample by one step per level, and
/// knows large cubes without leaves. It serves those who read samples far apart, from any thread.
class LeafTree {
 public:
  /// A cube of samples that are all outside, or all inside.
  struct EmptyCube {
    glm::ivec3 low;  ///< Its first sample.
    int32_t side;    ///< Number of samples along its side.
    float distance;  ///< The distance of all its samples, as `Field::distanceAt` gives it.
  };

  /// Keeps a reference to the band, which must be valid. Its distances may change, its leaves may not.
  explicit LeafTree(const Field& band);

  const Field& band() const { return band_; }

  /// Returns the place of a sample's values, or a negative number if it lies in no leaf. The sample must not
  /// be negative.
  int64_t find(const glm::ivec3& sample) const;
  /// Returns the block of a sample on the lattice.
  SparseBlock blockWith(const glm::ivec3& sample) const;
  /// Returns the block in another array of the band: NaN without a leaf.
  SparseBlock blockWith(const glm::ivec3& sample, const Buffer<float>& numbers) const;
  /// Returns the largest cube without leaves, of those that the tree knows, around a sample on the lattice.
  /// Ignores its samples beyond the lattice.
  std::optional<EmptyCube> emptyCube(const glm::ivec3& sample) const;

  static constexpr int kSlotBits = 3;  ///< A node has 8 x 8 x 8 slots, x fastest.
  static constexpr int64_t kOutside = -1, kInside = -2;
  /// A slot holds a node's index, in the lowest level a leaf's, or the side on which all its samples lie.
  using Node = std::array<int64_t, size_t{1} << 3 * kSlotBits>;

  /// Returns the nodes, the root first.
  const std::vector<Node>& nodes() const { return nodes_; }
  /// The slots of the root have 2^bits samples along a side.
  int rootBits() const { return rootBits_; }

 private:
  struct Slot {
    int64_t content;
    int bits;  ///< The slot's cube has 2^bits samples along its side.
  };

  static size_t placeOf(const glm::ivec3& sample, int bits) {
    const glm::ivec3 at = (sample >> bits) & ((1 << kSlotBits) - 1);
    return (((size_t(at.z) << kSlotBits) + size_t(at.y)) << kSlotBits) + size_t(at.x);
  }
  float distanceOf(int64_t side) const {
    return side == kInside ? -float(band_.narrow->inside) : float(band_.narrow->outside);
  }
  Slot slotOf(const glm::ivec3& sample) const;
  static SparseBlock leafBlock(int64_t leaf, const Buffer<float>& numbers, float elsewhere) {
    if (leaf < 0) return {nullptr, elsewhere};
    return {numbers.data() + size_t(leaf) * NarrowBand::kLeafSamples, 0.0f};
  }
  Node& nodeWith(const glm::ivec3& sample, int bits);
  void addTile(const NarrowBand::Tile& tile);

  const Field& band_;
  int rootBits_;
  std::vector<Node> nodes_;
};

inline LeafTree::Slot LeafTree::slotOf(const glm::ivec3& sample) const {
  int64_t content = 0;
  for (int bits = rootBits_;; bits -= kSlotBits) {
    content = nodes_[size_t(content)][placeOf(sample, bits)];
    if (content < 0 || bits == kSlotBits) return {content, bits};
  }
}

inline int64_t LeafTree::find(const glm::ivec3& sample) const {
  const int64_t leaf = slotOf(sample).content;
  return leaf < 0 ? leaf : leaf * int64_t(NarrowBand::kLeafSamples) + int64_t(placeOf(sample, 0));
}

inline SparseBlock LeafTree::blockWith(const glm::ivec3& sample) const {
  const int64_t leaf = slotOf(sample).content;
  return leafBlock(leaf, band_.distance, distanceOf(leaf));
}

inline SparseBlock LeafTree::blockWith(const glm::ivec3& sample, const Buffer<float>& numbers) const {
  return leafBlock(slotOf(sample).content, numbers, std::numeric_limits<float>::quiet_NaN());
}

inline std::optional<LeafTree::EmptyCube> LeafTree::emptyCube(const glm::ivec3& sample) const {
  const Slot slot = slotOf(sample);
  if (slot.content >= 0) return std::nullopt;
  return EmptyCube{(sample >> slot.bits) << slot.bits, int32_t{1} << slot.bits, distanceOf(slot.content)};
}

}  // namespace raymap
