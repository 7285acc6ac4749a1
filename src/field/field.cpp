#include <raymap/narrow_band.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <ranges>
#include <string>

#include "base/parallel.h"
#include "base/require.h"
#include "field/field_sampler.h"
#include "field/leaf_order.h"
#include "field/sparse_reader.h"

namespace raymap {

namespace {

/// Returns the last cube that begins at or before a sample's leaf on the curve, or the end.
template <class Cubes, class LowOf>
auto lastBefore(const Cubes& cubes, const glm::ivec3& sample, LowOf&& lowOf) {
  const auto after = std::ranges::upper_bound(cubes, blockOf(sample), comesBefore, lowOf);
  return after == std::ranges::begin(cubes) ? std::ranges::end(cubes) : std::prev(after);
}

bool contains(const glm::ivec3& low, int side, const glm::ivec3& sample) {
  return glm::all(glm::greaterThanEqual(sample, low)) && glm::all(glm::lessThan(sample, low + side));
}

std::string textOf(const glm::ivec3& sample) {
  return "(" + std::to_string(sample.x) + ", " + std::to_string(sample.y) + ", " + std::to_string(sample.z) +
         ")";
}

void checkCube(const glm::ivec3& low, int side, const glm::ivec3& dims, const char* what) {
  require(side >= NarrowBand::kLeafSide && std::has_single_bit(uint32_t(side)),
          std::string("the side of the ") + what + " at sample " + textOf(low) + " is " +
              std::to_string(side) + "; it must be 8 times a power of two");
  require(low % side == glm::ivec3(0) && glm::all(glm::greaterThanEqual(low, glm::ivec3(0))) &&
              glm::all(glm::lessThan(low, dims)),
          std::string("the ") + what + " at sample " + textOf(low) +
              " must begin on the lattice, at multiples of its side, " + std::to_string(side));
}

/// Checks that each cube begins where the one before has ended on the curve, or later.
template <class Cubes, class LowOf, class SideOf>
void checkOrder(const Cubes& cubes, const glm::ivec3& dims, const char* what, LowOf&& lowOf,
                SideOf&& sideOf) {
  uint64_t end = 0;
  for (const auto& cube : cubes) {
    const glm::ivec3 low = lowOf(cube);
    checkCube(low, sideOf(cube), dims, what);
    const uint64_t place = placeOnCurve(low), side = uint64_t(sideOf(cube) / NarrowBand::kLeafSide);
    require(place >= end, std::string("the ") + what + " at sample " + textOf(low) +
                              " must come before others: they are ordered along a Morton curve, x lowest");
    end = place + side * side * side;
  }
}

}  // namespace

void validate(const Field& field) {
  validateField(field);
  if (!field.narrow) {
    if (!field.triangle.empty()) validateArray(field, FieldArray::Triangle);
    if (!field.winding.empty()) validateArray(field, FieldArray::Winding);
    if (!field.confidence.empty()) validateArray(field, FieldArray::Confidence);
    return;
  }
  const NarrowBand& band = *field.narrow;
  const glm::ivec3 dims = field.grid.dims;
  require(std::max({dims.x, dims.y, dims.z}) <= kMostDims,
          "a lattice has at most " + std::to_string(kMostDims) + " samples along each axis");
  require(band.outside > 0.0 && std::isfinite(band.outside), "the band outside must be positive and finite");
  require(band.inside > 0.0, "the band inside must be positive");
  checkOrder(std::span<const glm::ivec3>(band.leaves), dims, "leaf", std::identity(),
             [](const glm::ivec3&) { return NarrowBand::kLeafSide; });
  checkOrder(
      band.tiles, dims, "tile", [](const NarrowBand::Tile& tile) { return tile.low; },
      [](const NarrowBand::Tile& tile) { return tile.side; });
}

void validateField(const Field& field) {
  if (!field.narrow) return validateArray(field, FieldArray::Distance);
  validateGrid(field.grid);
  const size_t leaves = field.narrow->leaves.size();
  const auto check = [&](size_t size, const char* values) {
    require(size == leaves * NarrowBand::kLeafSamples, "the narrow band holds " + std::to_string(size) + " " +
                                                           values + " but has " + std::to_string(leaves) +
                                                           " leaves of 512 samples");
  };
  check(field.distance.size(), "distances");
  if (!field.triangle.empty()) check(field.triangle.size(), "triangles");
  if (!field.winding.empty()) check(field.winding.size(), "winding numbers");
  if (!field.confidence.empty()) check(field.confidence.size(), "confidences");
}

std::optional<size_t> NarrowBand::find(const glm::ivec3& sample) const {
  if (glm::any(glm::lessThan(sample, glm::ivec3(0)))) return std::nullopt;
  const std::span<const glm::ivec3> lows = leaves;
  const auto leaf = lastBefore(lows, sample, std::identity());
  if (leaf == lows.end() || !contains(*leaf, kLeafSide, sample)) return std::nullopt;
  const glm::ivec3 within = sample - *leaf;
  return size_t(leaf - lows.begin()) * kLeafSamples +
         size_t((within.z * kLeafSide + within.y) * kLeafSide + within.x);
}

float Field::distanceAt(const glm::ivec3& sample) const {
  if (!narrow) return distance[grid.index(sample)];
  if (const std::optional<size_t> place = narrow->find(sample)) return distance[*place];
  const auto outside = float(narrow->outside);
  const bool isOnLattice =
      glm::all(glm::greaterThanEqual(sample, glm::ivec3(0))) && glm::all(glm::lessThan(sample, grid.dims));
  if (!isOnLattice) return outside;
  const auto& tiles = narrow->tiles;
  const auto tile = lastBefore(tiles, sample, [](const NarrowBand::Tile& each) { return each.low; });
  return tile != tiles.end() && contains(tile->low, tile->side, sample) ? -float(narrow->inside) : outside;
}

bool Field::has(FieldArray array) const {
  switch (array) {
    case FieldArray::Winding:
      return !winding.empty();
    case FieldArray::Confidence:
      return !confidence.empty();
    case FieldArray::Triangle:
      return !triangle.empty();
    case FieldArray::Distance:
      break;
  }
  return narrow || !distance.empty();
}

std::vector<FieldArray> Field::arrays() const {
  std::vector<FieldArray> held;
  for (const FieldArray array :
       {FieldArray::Distance, FieldArray::Winding, FieldArray::Confidence, FieldArray::Triangle})
    if (has(array)) held.push_back(array);
  return held;
}

double Field::clamp() const {
  return narrow ? std::min(narrow->inside, narrow->outside) : clampDistance;
}

size_t Field::activeCount() const {
  const double most = clampDistance > 0.0 ? clampDistance : INFINITY;
  const auto isActive = [&](float value) {
    return narrow ? narrow->isActive(value) : std::abs(value) < float(most);
  };
  std::atomic<size_t> count{0};
  parallelFor(distance.size(), kCheapGrain, [&](size_t begin, size_t end) {
    count += size_t(std::count_if(distance.begin() + begin, distance.begin() + end, isActive));
  });
  return count;
}

size_t Field::bytes() const {
  const size_t arrays = distance.capacityBytes() + triangle.capacityBytes() + winding.capacityBytes() +
                        confidence.capacityBytes();
  return narrow
             ? arrays + narrow->leaves.capacityBytes() + narrow->tiles.capacity() * sizeof(NarrowBand::Tile)
             : arrays;
}

}  // namespace raymap
