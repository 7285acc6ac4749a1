#include "isosurface/field_values.h"

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/text.h"
#include "field/field_sampler.h"

namespace raymap {

namespace {

struct Range {
  float low = INFINITY, high = -INFINITY;

  void add(float value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void add(const Range& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

void checkFinite(float value, const glm::ivec3& sample) {
  if (!std::isfinite(value))
    throw Error(ErrorCode::Input, "sample (" + std::to_string(sample.x) + ", " + std::to_string(sample.y) +
                                      ", " + std::to_string(sample.z) + ") of the field is " +
                                      numberText(value) +
                                      ": a surface needs finite samples; make the field again");
}

/// Returns the range of `count` parts, of which `add(part, range)` adds one.
template <class Add>
Range rangeOfParts(size_t count, Add&& add) {
  std::vector<Range> ranges(count);
  parallelFor(count, 1, [&](size_t begin, size_t end) {
    for (size_t part = begin; part < end; ++part) add(part, ranges[part]);
  });
  Range all;
  for (const Range& range : ranges) all.add(range);
  return all;
}

/// Returns the range of the values. Throws `Error(Input)` if a sample is not finite.
Range denseRange(const Field& field) {
  const glm::ivec3 dims = field.grid.dims;
  return rangeOfParts(size_t(dims.z), [&](size_t k, Range& range) {
    size_t i = field.grid.index({0, 0, k});
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) {
        checkFinite(field.distance[i], {x, y, k});
        range.add(field.distance[i++]);
      }
  });
}

/// Calls `visit(sample, value)` for the samples of a leaf that lie on the lattice.
template <class Visit>
void forEachOnLattice(const Field& band, size_t leaf, Visit&& visit) {
  const float* value = band.distance.data() + leaf * NarrowBand::kLeafSamples;
  constexpr int kSide = NarrowBand::kLeafSide;
  for (int z = 0; z < kSide; ++z)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x, ++value) {
        const glm::ivec3 sample = band.narrow->leaves[leaf] + glm::ivec3(x, y, z);
        if (glm::all(glm::lessThan(sample, band.grid.dims))) visit(sample, *value);
      }
}

/// Does the same for a band. It may have samples in no leaf and in no tile, which are outside.
Range narrowRange(const Field& band) {
  constexpr size_t kLeavesPerPart = 64;
  const size_t leaves = band.narrow->leaves.size();
  Range range =
      rangeOfParts((leaves + kLeavesPerPart - 1) / kLeavesPerPart, [&](size_t part, Range& partRange) {
        const size_t end = std::min((part + 1) * kLeavesPerPart, leaves);
        for (size_t leaf = part * kLeavesPerPart; leaf < end; ++leaf)
          forEachOnLattice(band, leaf, [&](const glm::ivec3& sample, float value) {
            checkFinite(value, sample);
            partRange.add(value);
          });
      });
  range.add(float(band.narrow->outside));
  if (!band.narrow->tiles.empty()) range.add(-float(band.narrow->inside));
  return range;
}

std::string shortText(double value) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%g", value);
  return digits.data();
}

void checkRange(const Range& range, double iso) {
  if (!(range.low < iso))
    throw Error(ErrorCode::Usage, "there is no surface at " + shortText(iso) +
                                      ": the field's values go from " + shortText(range.low) + " to " +
                                      shortText(range.high) + "; choose a distance between them");
}

bool denseReachesBox(const Field& field, double iso) {
  const glm::ivec3 last = field.grid.dims - 1;
  for (int k = 0; k <= last.z; ++k)
    for (int j = 0; j <= last.y; ++j) {
      const bool isSide = k == 0 || k == last.z || j == 0 || j == last.y;
      for (int i = 0; i <= last.x; i += isSide ? 1 : std::max(last.x, 1))
        if (field.distance[field.grid.index({i, j, k})] < iso) return true;
    }
  return false;
}

bool narrowReachesBox(const Field& band, double iso) {
  const glm::ivec3 last = band.grid.dims - 1;
  const auto touches = [&](const glm::ivec3& low, int side) {
    return glm::any(glm::equal(low, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(low + side - 1, last));
  };
  if (std::ranges::any_of(band.narrow->tiles,
                          [&](const NarrowBand::Tile& tile) { return touches(tile.low, tile.side); }))
    return true;
  bool reaches = false;
  for (size_t leaf = 0; leaf < band.narrow->leaves.size() && !reaches; ++leaf)
    if (touches(band.narrow->leaves[leaf], NarrowBand::kLeafSide))
      forEachOnLattice(band, leaf, [&](const glm::ivec3& sample, float value) {
        reaches |= value < iso && touches(sample, 1);
      });
  return reaches;
}

}  // namespace

void checkValues(const Field& field, double iso) {
  validateArray(field, FieldArray::Distance);
  checkRange(field.narrow ? narrowRange(field) : denseRange(field), iso);
  if (const auto& band = field.narrow; band && (iso >= band->outside || iso <= -band->inside))
    throw Error(ErrorCode::Usage, "there is no surface at " + shortText(iso) +
                                      ": the band's distances are clamped at " + shortText(-band->inside) +
                                      " and " + shortText(band->outside));
  if (field.clampDistance > 0.0 && std::abs(iso) >= field.clampDistance)
    throw Error(ErrorCode::Usage, "there is no surface at " + shortText(iso) +
                                      ": the field's distances are clamped at " +
                                      shortText(field.clampDistance));
}

bool reachesBox(const Field& field, double iso) {
  return field.narrow ? narrowReachesBox(field, iso) : denseReachesBox(field, iso);
}

}  // namespace raymap
