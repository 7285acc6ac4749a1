#pragma once

#include <raymap/narrow_band.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "field/leaf_order.h"

namespace raymap {

/// Adds the next tile along the curve to those of a lattice. Joins tiles that fill a larger cube; parts of it
/// beyond the lattice are ignored. So equal insides have equal tiles.
inline void addTile(std::vector<NarrowBand::Tile>& tiles, const NarrowBand::Tile& tile,
                    const glm::ivec3& dims) {
  tiles.push_back(tile);
  for (;;) {
    const int side = tiles.back().side;
    if (side >= std::max({dims.x, dims.y, dims.z})) return;
    const glm::ivec3 low = tiles.back().low & ~(2 * side - 1);
    size_t parts = 1;
    for (int axis = 0; axis < 3; ++axis)
      if (low[axis] + side < dims[axis]) parts *= 2;
    // As many tiles of this size, the first of them at the corner, are all parts of the larger cube.
    const auto isOfThisSize = [&](const NarrowBand::Tile& each) { return each.side == side; };
    if (tiles.size() < parts || tiles[tiles.size() - parts].low != low ||
        !std::all_of(tiles.end() - static_cast<std::ptrdiff_t>(parts), tiles.end(), isOfThisSize))
      return;
    tiles.resize(tiles.size() - parts);
    tiles.push_back({low, 2 * side});
  }
}

/// Orders tiles along the curve, and joins them.
inline std::vector<NarrowBand::Tile> joined(std::vector<NarrowBand::Tile> tiles, const glm::ivec3& dims) {
  std::ranges::sort(tiles, comesBefore, &NarrowBand::Tile::low);
  std::vector<NarrowBand::Tile> result;
  for (const NarrowBand::Tile& tile : tiles) addTile(result, tile, dims);
  return result;
}

}  // namespace raymap
