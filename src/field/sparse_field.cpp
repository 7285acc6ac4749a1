#include <raymap/sparse_field.h>

#include <algorithm>
#include <atomic>
#include <ranges>

#include "base/parallel.h"
#include "field/leaf_order.h"

namespace raymap {

namespace {

/// Returns the last cube that begins at or before a sample on the curve, or the end.
template <class Cubes, class LowOf>
auto lastBefore(const Cubes& cubes, const glm::ivec3& sample, LowOf&& lowOf) {
  const auto after = std::ranges::upper_bound(cubes, placeOnCurve(sample), {},
                                              [&](const auto& cube) { return placeOnCurve(lowOf(cube)); });
  return after == std::ranges::begin(cubes) ? std::ranges::end(cubes) : std::prev(after);
}

bool contains(const glm::ivec3& low, int side, const glm::ivec3& sample) {
  return glm::all(glm::greaterThanEqual(sample, low)) && glm::all(glm::lessThan(sample, low + side));
}

}  // namespace

std::optional<size_t> SparseField::find(const glm::ivec3& sample) const {
  if (glm::any(glm::lessThan(sample, glm::ivec3(0)))) return std::nullopt;
  const std::span<const glm::ivec3> lows = leaves;
  const auto leaf = lastBefore(lows, sample, std::identity());
  if (leaf == lows.end() || !contains(*leaf, kLeafSide, sample)) return std::nullopt;
  const glm::ivec3 within = sample - *leaf;
  return size_t(leaf - lows.begin()) * kLeafSamples +
         size_t((within.z * kLeafSide + within.y) * kLeafSide + within.x);
}

float SparseField::distanceAt(const glm::ivec3& sample) const {
  if (const std::optional<size_t> place = find(sample)) return distance[*place];
  const bool isOnLattice =
      glm::all(glm::greaterThanEqual(sample, glm::ivec3(0))) && glm::all(glm::lessThan(sample, grid.dims));
  if (!isOnLattice) return float(outside);
  const auto tile = lastBefore(tiles, sample, [](const Tile& each) { return each.low; });
  return tile != tiles.end() && contains(tile->low, tile->side, sample) ? -float(inside) : float(outside);
}

size_t SparseField::activeCount() const {
  std::atomic<size_t> count{0};
  parallelFor(distance.size(), kCheapGrain, [&](size_t begin, size_t end) {
    count += size_t(std::count_if(distance.begin() + begin, distance.begin() + end,
                                  [&](float value) { return isActive(value); }));
  });
  return count;
}

size_t SparseField::bytes() const {
  return leaves.capacityBytes() + distance.capacityBytes() + triangle.capacityBytes() +
         winding.capacityBytes() + confidence.capacityBytes() + tiles.capacity() * sizeof(Tile);
}

}  // namespace raymap
