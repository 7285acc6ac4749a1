#include "field/empty_space.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace raymap {

namespace {

constexpr uint8_t kFarthest = std::numeric_limits<uint8_t>::max();

/// Calls `visit(cube)` for all cubes, or in the reverse order.
template <class Visit>
void forEachCube(const glm::ivec3& dims, bool isReversed, Visit&& visit) {
  const auto at = [&](int n, int count) { return isReversed ? count - 1 - n : n; };
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) visit(glm::ivec3(at(x, dims.x), at(y, dims.y), at(z, dims.z)));
}

}  // namespace

EmptySpace::EmptySpace(const Field& band) {
  const glm::ivec3 dims = band.grid.dims;
  const int longest = std::max({dims.x, dims.y, dims.z});
  bits_ = std::bit_width(uint32_t(NarrowBand::kLeafSide) - 1);
  while ((longest - 1) >> bits_ >= kMostCubes) ++bits_;
  dims_ = ((dims - 1) >> bits_) + 1;
  away_.assign(size_t(dims_.x) * size_t(dims_.y) * size_t(dims_.z), kFarthest);
  for (const glm::ivec3& leaf : band.narrow->leaves) markFilled(leaf, leaf);
  for (const NarrowBand::Tile& tile : band.narrow->tiles)
    markFilled(tile.low, glm::min(tile.low + (tile.side - 1), dims - 1));
  measure();
}

void EmptySpace::markFilled(const glm::ivec3& first, const glm::ivec3& last) {
  const glm::ivec3 low = first >> bits_, high = last >> bits_;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y) {
      const auto row = away_.begin() + std::ptrdiff_t(index({low.x, y, z}));
      std::fill(row, row + (high.x - low.x + 1), uint8_t{0});
    }
}

/// Takes the distances from neighbours that came before, forwards and backwards. This is exact for the
/// chessboard distance: A. Rosenfeld and J. L. Pfaltz, "Distance functions on digital pictures", Pattern
/// Recognition 1 (1968).
void EmptySpace::measure() {
  for (const bool isReversed : {false, true})
    forEachCube(dims_, isReversed, [&](const glm::ivec3& cube) {
      uint8_t& away = away_[index(cube)];
      for (int n = 0; n < 13; ++n) {  // The first half of the 27 cubes around, in order.
        const glm::ivec3 offset = glm::ivec3(n % 3, n / 3 % 3, n / 9) - 1;
        const glm::ivec3 other = isReversed ? cube - offset : cube + offset;
        const bool isThere =
            glm::all(glm::greaterThanEqual(other, glm::ivec3(0))) && glm::all(glm::lessThan(other, dims_));
        if (isThere && away_[index(other)] < away) away = std::min<uint8_t>(away, away_[index(other)] + 1);
      }
    });
}

std::optional<SampleBox> EmptySpace::boxAround(const glm::ivec3& sample) const {
  const glm::ivec3 cube = sample >> bits_;
  const int away = away_[index(cube)];
  if (away == 0) return std::nullopt;
  const auto begin = [&](int n) { return (cube + n) * (1 << bits_); };
  return SampleBox{begin(1 - away), begin(away) - 1};
}

}  // namespace raymap
