// Narrow bands from dense fields, and the reverse.

#include <raymap/error.h>
#include <raymap/narrow_band.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/memory.h"
#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "base/require.h"
#include "base/text.h"
#include "field/field_sampler.h"
#include "field/join_tiles.h"
#include "field/leaf_order.h"
#include "field/sparse_reader.h"

namespace raymap {

namespace {

constexpr int kSide = NarrowBand::kLeafSide;
constexpr size_t kLeafSamples = NarrowBand::kLeafSamples;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
/// Share by which a band may exceed the distance at which a field is clamped, for rounding.
constexpr double kWidthRounding = 1e-6;

uint64_t limitOf(const MachineOptions& machine) {
  return mostMemory(machine.memoryLimit);
}

/// Calls `visit(first, within, count)` for each row along x of a cube's samples in a region: the index of its
/// first sample in the region, its place in the cube, and its length.
template <class Visit>
void forEachRow(const Region& region, const glm::ivec3& low, int side, Visit&& visit) {
  const glm::ivec3 begin = glm::max(low, region.low), end = glm::min(low + side, region.low + region.size);
  const Grid inRegion{.dims = region.size};
  for (int z = begin.z; z < end.z; ++z)
    for (int y = begin.y; y < end.y && begin.x < end.x; ++y) {
      const glm::ivec3 first(begin.x, y, z), within = first - low;
      visit(inRegion.index(first - region.low),
            (size_t(within.z) * size_t(side) + size_t(within.y)) * size_t(side) + size_t(within.x),
            size_t(end.x - begin.x));
    }
}

Region wholeOf(const Grid& grid) {
  return {glm::ivec3(0), grid.dims};
}

template <class Number>
void fillWith(Buffer<Number>& array, size_t count, Number value) {
  array.resizeUninitialized(count);
  parallelFor(count, kCheapGrain, [&](size_t begin, size_t end) {
    std::fill(array.begin() + begin, array.begin() + end, value);
  });
}

void checkDenseMemory(const Field& band, const Region& region, const MachineOptions& machine) {
  const glm::dvec3 dims(region.size);
  const int arrays = 1 + (band.triangle.empty() ? 0 : 1) + (band.winding.empty() ? 0 : 1) +
                     (band.confidence.empty() ? 0 : 1);
  // Samples of large lattices have no number of 64 bits.
  const double bytes = dims.x * dims.y * dims.z * double(sizeof(float)) * arrays;
  constexpr double kMost = 0x1p63;
  checkFieldMemory(uint64_t(std::min(bytes, kMost)), limitOf(machine));
}

/// Copies the values of all leaves to the field of a region.
template <class Number>
void copyLeaves(const Field& band, const Buffer<Number>& from, const Region& region, Buffer<Number>& to) {
  parallelFor(band.narrow->leaves.size(), 64, [&](size_t begin, size_t end) {
    for (size_t leaf = begin; leaf < end; ++leaf)
      forEachRow(region, band.narrow->leaves[leaf], kSide, [&](size_t first, size_t within, size_t count) {
        std::copy_n(from.data() + leaf * kLeafSamples + within, count, to.data() + first);
      });
  });
}

template <class Number>
void spread(const Field& band, const Buffer<Number>& from, Number elsewhere, const Region& region,
            Buffer<Number>& to) {
  if (from.empty()) return;
  fillWith(to, Grid{.dims = region.size}.sampleCount(), elsewhere);
  copyLeaves(band, from, region, to);
}

void makeDense(const Field& band, const Region& region, Field& field) {
  fillWith(field.distance, field.grid.sampleCount(), float(band.narrow->outside));
  parallelFor(band.narrow->tiles.size(), 1, [&](size_t t, size_t) {
    const NarrowBand::Tile& tile = band.narrow->tiles[t];
    forEachRow(region, tile.low, tile.side, [&](size_t first, size_t, size_t count) {
      std::fill_n(field.distance.data() + first, count, -float(band.narrow->inside));
    });
  });
  copyLeaves(band, band.distance, region, field.distance);
  spread(band, band.triangle, kNoTriangle, region, field.triangle);
  spread(band, band.winding, kUnknown, region, field.winding);
  spread(band, band.confidence, kUnknown, region, field.confidence);
}

void checkWidth(const Field& field, double width, const char* side) {
  require(width > 0.0, std::string("the band ") + side + " must be positive");
  if (field.clampDistance > 0.0 && width * field.grid.spacing > field.clampDistance * (1.0 + kWidthRounding))
    throw Error(ErrorCode::Usage, std::string("the band ") + side + " is " + numberText(width) +
                                      " samples wide, but the field's distances are clamped at " +
                                      numberText(field.clampDistance / field.grid.spacing) +
                                      " samples; choose a band of that width or less");
}

void check(const Field& field, const BandOptions& options) {
  requireDense(field);
  validateField(field);
  require(std::isfinite(options.outside), "the band outside must be finite");
  checkWidth(field, options.outside, "outside");
  checkWidth(field, options.inside, "inside");
  if (options.triangle) validateArray(field, FieldArray::Triangle);
  if (options.winding) validateArray(field, FieldArray::Winding);
  if (options.confidence) validateArray(field, FieldArray::Confidence);
}

/// Finds the leaves and tiles of a dense field, and fills them.
class SparseMaker {
 public:
  SparseMaker(const Field& field, const BandOptions& options) : field_(field), options_(options) {
    band_.grid = field.grid;
    band_.narrow.emplace();
    band_.narrow->outside = options.outside * field.grid.spacing;
    band_.narrow->inside = options.inside * field.grid.spacing;
    band_.surfaceBounds = field.surfaceBounds;
  }

  Field make(uint64_t most) {
    const std::vector<glm::ivec3> blocks = blocksInOrder();
    std::vector<Kind> kinds(blocks.size());
    parallelFor(blocks.size(), 64, [&](size_t begin, size_t end) {
      for (size_t b = begin; b < end; ++b) kinds[b] = kindOf(blocks[b]);
    });
    std::vector<glm::ivec3> leaves;
    for (size_t b = 0; b < blocks.size(); ++b) {
      if (kinds[b] == Kind::Leaf) leaves.push_back(blocks[b]);
      if (kinds[b] == Kind::Inside) addTile(band_.narrow->tiles, {blocks[b], kSide}, band_.grid.dims);
    }
    fill(leaves, most);
    return std::move(band_);
  }

 private:
  enum class Kind : uint8_t { Outside, Inside, Leaf };

  std::vector<glm::ivec3> blocksInOrder() const {
    std::vector<glm::ivec3> blocks;
    const glm::ivec3 dims = field_.grid.dims;
    for (int z = 0; z < dims.z; z += kSide)
      for (int y = 0; y < dims.y; y += kSide)
        for (int x = 0; x < dims.x; x += kSide) blocks.emplace_back(x, y, z);
    parallelSort(blocks.begin(), blocks.end(), comesBefore);
    return blocks;
  }

  float clamped(float distance) const {
    return float(std::clamp(double(distance), -band_.narrow->inside, band_.narrow->outside));
  }

  Kind kindOf(const glm::ivec3& low) const {
    bool isActive = false, hasInside = false, hasOutside = false;
    forEachRow(wholeOf(field_.grid), low, kSide, [&](size_t first, size_t, size_t count) {
      for (size_t i = first; i < first + count; ++i) {
        if (std::isnan(field_.distance[i])) throwNaN(i);
        const float value = clamped(field_.distance[i]);
        isActive |= band_.narrow->isActive(value);
        (value < 0.0f ? hasInside : hasOutside) = true;
      }
    });
    if (isActive || (hasInside && hasOutside)) return Kind::Leaf;
    return hasInside ? Kind::Inside : Kind::Outside;
  }

  [[noreturn]] void throwNaN(size_t i) const {
    const glm::ivec3 dims = field_.grid.dims;
    throw Error(ErrorCode::Input, "sample (" + std::to_string(i % dims.x) + ", " +
                                      std::to_string(i / dims.x % dims.y) + ", " +
                                      std::to_string(i / dims.x / dims.y) +
                                      ") of the field is NaN: a band needs numbers; make the field again");
  }

  void fill(const std::vector<glm::ivec3>& leaves, uint64_t most) {
    const size_t arrays =
        1 + (options_.triangle ? 1 : 0) + (options_.winding ? 1 : 0) + (options_.confidence ? 1 : 0);
    checkFieldMemory(leaves.size() * (sizeof(glm::ivec3) + arrays * sizeof(float) * kLeafSamples), most);
    band_.narrow->leaves.resizeUninitialized(leaves.size());
    std::ranges::copy(leaves, band_.narrow->leaves.begin());
    gather(field_.distance, float(band_.narrow->outside), band_.distance,
           [this](float d) { return clamped(d); });
    const auto same = [](auto value) { return value; };
    if (options_.triangle) gather(field_.triangle, kNoTriangle, band_.triangle, same);
    if (options_.winding) gather(field_.winding, 0.0f, band_.winding, same);
    if (options_.confidence) gather(field_.confidence, 0.0f, band_.confidence, same);
    for (size_t i = 0; i < band_.triangle.size(); ++i)
      if (!band_.narrow->isActive(band_.distance[i])) band_.triangle[i] = kNoTriangle;
  }

  template <class Number, class Convert>
  void gather(const Buffer<Number>& from, Number beyond, Buffer<Number>& to, Convert&& convert) const {
    fillWith(to, band_.narrow->leaves.size() * kLeafSamples, beyond);
    parallelFor(band_.narrow->leaves.size(), 64, [&](size_t begin, size_t end) {
      for (size_t leaf = begin; leaf < end; ++leaf)
        forEachRow(wholeOf(field_.grid), band_.narrow->leaves[leaf], kSide,
                   [&](size_t first, size_t within, size_t count) {
                     std::transform(from.data() + first, from.data() + first + count,
                                    to.data() + leaf * kLeafSamples + within, convert);
                   });
    });
  }

  const Field& field_;
  const BandOptions& options_;
  Field band_;
};

}  // namespace

Field toDense(const Field& band, const MachineOptions& machine) {
  return toDense(band, wholeOf(band.grid), machine);
}

Field toDense(const Field& band, const Region& region, const MachineOptions& machine) {
  requireNarrow(band);
  validate(band);
  require(glm::all(glm::greaterThanEqual(region.low, glm::ivec3(0))) &&
              glm::all(glm::greaterThan(region.size, glm::ivec3(0))) &&
              glm::all(glm::lessThanEqual(region.size, band.grid.dims - region.low)),
          "the region must hold samples, and lie on the band's lattice");
  checkDenseMemory(band, region, machine);
  Field field{.grid = {region.size, band.grid.position(region.low), band.grid.spacing},
              .clampDistance = band.clamp(),
              .surfaceBounds = band.surfaceBounds};
  withThreads(machine.threads, [&] { makeDense(band, region, field); });
  return field;
}

Field toSparse(const Field& field, const BandOptions& options, const MachineOptions& machine) {
  check(field, options);
  Field band;
  withThreads(machine.threads, [&] { band = SparseMaker(field, options).make(limitOf(machine)); });
  return band;
}

}  // namespace raymap
