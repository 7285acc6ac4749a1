#include "field/leaf_tree.h"

#include <algorithm>
#include <bit>

namespace raymap {

namespace {

/// Returns the number of bits of the largest coordinate of a sample.
int bitsOf(const glm::ivec3& dims) {
  return std::bit_width(uint32_t(std::max({dims.x, dims.y, dims.z}) - 1));
}

}  // namespace

LeafTree::LeafTree(const Field& band) : band_(band), rootBits_(kSlotBits), nodes_(1) {
  static_assert(NarrowBand::kLeafSide == 1 << kSlotBits);
  while (rootBits_ + kSlotBits < bitsOf(band.grid.dims)) rootBits_ += kSlotBits;
  nodes_[0].fill(kOutside);
  for (size_t leaf = 0; leaf < band.narrow->leaves.size(); ++leaf)
    nodeWith(band.narrow->leaves[leaf], kSlotBits)[placeOf(band.narrow->leaves[leaf], kSlotBits)] =
        int64_t(leaf);
  for (const NarrowBand::Tile& tile : band.narrow->tiles) addTile(tile);
}

/// Returns the node of a sample whose slots have 2^bits samples along a side. Makes those that are missing.
LeafTree::Node& LeafTree::nodeWith(const glm::ivec3& sample, int bits) {
  size_t node = 0;
  for (int level = rootBits_; level > bits; level -= kSlotBits) {
    const size_t place = placeOf(sample, level);
    if (nodes_[node][place] < 0) {
      nodes_[node][place] = int64_t(nodes_.size());
      nodes_.emplace_back().fill(kOutside);
    }
    node = size_t(nodes_[node][place]);
  }
  return nodes_[node];
}

/// Fills the largest slots that a tile holds. They lie in one node, because a tile begins at multiples of its
/// side.
void LeafTree::addTile(const NarrowBand::Tile& tile) {
  const int tileBits = std::countr_zero(uint32_t(tile.side));
  const int bits = std::min(tileBits / kSlotBits * kSlotBits, rootBits_);
  const int count = std::min(1 << (tileBits - bits), 1 << kSlotBits), side = 1 << bits;
  Node& node = nodeWith(tile.low, bits);
  for (int z = 0; z < count; ++z)
    for (int y = 0; y < count; ++y)
      for (int x = 0; x < count; ++x) node[placeOf(tile.low + side * glm::ivec3(x, y, z), bits)] = kInside;
}

}  // namespace raymap
