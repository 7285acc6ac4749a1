// Fields of a part of a lattice, whose samples are queried block by block, one thread a block. With a band,
// blocks and cubes in them that lie wholly beyond it cost one query each.

#include "cpu/points/region.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cpu/points/far_cubes.h"
#include "cpu/points/lattice_query.h"

namespace raymap::cpu {

namespace {

constexpr int kSide = LatticeQuery::kSide;
constexpr int kSideOfBlock = LatticeQuery::kDistanceSide;
constexpr size_t kBlocksAtOnce = 4096;

/// Returns a corner of the grid of 4 x 4 x 4 unit cubes, numbered along a Morton curve.
glm::ivec3 placeInBlock(int number) {
  return 2 * cornerOf(number >> 3) + cornerOf(number & 7);
}

class RegionMaker {
 public:
  RegionMaker(const PreparedSurface& surface, const Grid& lattice, const Region& region,
              const RegionOptions& options, Progress& progress)
      : surface_(surface),
        lattice_(lattice),
        region_(region),
        options_(options),
        progress_(progress),
        high_(region.low + region.size),
        firstPair_(region.low / (2 * kSideOfBlock)),
        pairs_((high_ - 1) / (2 * kSideOfBlock) - firstPair_ + 1),
        band_{options.band * lattice.spacing, options.band * lattice.spacing} {
    field_.grid = {region.size, lattice.position(glm::dvec3(region.low)), lattice.spacing};
    field_.clampDistance = band_.outside;
    field_.surfaceBounds = bounds(MeshView(surface.mesh));
  }

  Field make() {
    const size_t samples = field_.grid.sampleCount();
    field_.distance.resizeUninitialized(samples);
    field_.triangle.resizeUninitialized(options_.triangle ? samples : 0);
    field_.winding.resizeUninitialized(options_.winding ? samples : 0);
    field_.confidence.resizeUninitialized(options_.confidence ? samples : 0);
    progress_.stage("region", [&] { fill(); });
    return std::move(field_);
  }

 private:
  void fill() {
    const size_t pairs = size_t(pairs_.x) * size_t(pairs_.y) * size_t(pairs_.z);
    WorkMeter meter(progress_, 0.0, 1.0, double(8 * pairs));
    for (size_t begin = 0, end = 0; begin < pairs; begin = end) {
      end = std::min(begin + kBlocksAtOnce / 8, pairs);
      const std::vector<glm::ivec3> blocks = blocksOf(begin, end);
      fillBlocks(blocks, meter);
      meter.add(8 * (end - begin) - blocks.size());  // Those outside of the region.
    }
  }

  /// Returns the blocks with samples of the region in the groups of eight numbered [begin, end).
  std::vector<glm::ivec3> blocksOf(size_t begin, size_t end) const {
    std::vector<glm::ivec3> blocks;
    const size_t x = size_t(pairs_.x), y = size_t(pairs_.y);
    for (size_t pair = begin; pair < end; ++pair)
      for (int one = 0; one < 8; ++one) {
        const glm::ivec3 low = 2 * (firstPair_ + glm::ivec3(pair % x, pair / x % y, pair / x / y));
        addIfInside(kSideOfBlock * (low + cornerOf(one)), kSideOfBlock, blocks);
      }
    return blocks;
  }

  /// Adds a cube if it holds samples of the region.
  void addIfInside(const glm::ivec3& cube, int side, std::vector<glm::ivec3>& cubes) const {
    if (glm::all(glm::lessThan(cube, high_)) && glm::all(glm::greaterThan(cube + side, region_.low)))
      cubes.push_back(cube);
  }

  void fillBlocks(std::span<const glm::ivec3> blocks, WorkMeter& meter);
  void fillNear(LatticeQuery& query, const glm::ivec3& block);

  /// Returns whether cubes beyond the band have one value. Winding numbers and confidences still differ
  /// there.
  bool hasFarCubes() const { return options_.band > 0.0 && !options_.winding && !options_.confidence; }

  void fillFar(const glm::ivec3& cube, int side, Side at) {
    const auto clamp = float(field_.clampDistance), value = at == Side::Inside ? -clamp : clamp;
    const glm::ivec3 low = glm::max(cube, region_.low), high = glm::min(cube + side, high_);
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y) {
        const size_t first = indexOf({low.x, y, z}), count = size_t(high.x - low.x);
        std::fill_n(field_.distance.begin() + first, count, value);
        if (options_.triangle) std::fill_n(field_.triangle.begin() + first, count, kNoTriangle);
      }
  }

  /// Takes what was found at a point for a sample.
  void keep(const QueryResult& found, size_t point, size_t index) {
    field_.distance[index] = static_cast<float>(found.distance[point]);
    const bool isClamped =
        options_.band > 0.0 && std::abs(field_.distance[index]) >= float(field_.clampDistance);
    if (options_.triangle) field_.triangle[index] = isClamped ? kNoTriangle : found.triangle[point];
    if (options_.winding) field_.winding[index] = found.winding[point];
    if (options_.confidence) field_.confidence[index] = found.confidence[point];
  }

  size_t indexOf(const glm::ivec3& sample) const { return field_.grid.index(sample - region_.low); }

  const PreparedSurface& surface_;
  const Grid& lattice_;
  const Region& region_;
  const RegionOptions& options_;
  Progress& progress_;
  glm::ivec3 high_;               ///< After the region's last sample.
  glm::ivec3 firstPair_, pairs_;  ///< The first group of 2 x 2 x 2 blocks along each axis, and their number.
  BandWidths band_;
  Field field_;
};

/// Fills blocks side by side. Those that share a cube of twice the side follow each other.
void RegionMaker::fillBlocks(std::span<const glm::ivec3> blocks, WorkMeter& meter) {
  std::vector<Side> sides(blocks.size(), Side::Unknown);
  Progress quiet;
  if (hasFarCubes()) FarCubes(surface_, lattice_, band_).find(blocks, kSideOfBlock, quiet, sides);
  const QueryOptions options{.triangle = options_.triangle,
                             .winding = options_.winding,
                             .confidence = options_.confidence,
                             .maxDistance = options_.band > 0.0 ? band_.outside : INFINITY};
  askInBlocks(surface_, lattice_, region_, options, blocks.size(), meter, [&](LatticeQuery& query, size_t b) {
    if (sides[b] == Side::Unknown)
      fillNear(query, blocks[b]);
    else
      fillFar(blocks[b], kSideOfBlock, sides[b]);
  });
}

void RegionMaker::fillNear(LatticeQuery& query, const glm::ivec3& block) {
  std::vector<glm::ivec3> cubes;
  for (int c = 0; c < 64; ++c) addIfInside(block + kSide * placeInBlock(c), kSide, cubes);
  std::vector<Side> sides(cubes.size(), Side::Unknown);
  Progress quiet;
  if (hasFarCubes()) FarCubes(surface_, lattice_, band_).find(cubes, kSide, quiet, sides);
  std::vector<AskedCube> near;
  for (size_t c = 0; c < cubes.size(); ++c)
    if (sides[c] == Side::Unknown)
      near.push_back({cubes[c]});
    else
      fillFar(cubes[c], kSide, sides[c]);
  query.ask(near);
  for (size_t k = 0; k < near.size(); ++k)
    query.visit(
        k, [&](const glm::ivec3& sample, size_t point) { keep(query.answers(), point, indexOf(sample)); });
}

}  // namespace

size_t regionBytes(const glm::ivec3& size, const RegionOptions& options) {
  constexpr size_t kMostSamples = SIZE_MAX / 256;  // More than any memory holds.
  const size_t plane = size_t(size.x) * size_t(size.y),
               samples = size_t(size.z) > kMostSamples / plane ? kMostSamples : plane * size_t(size.z),
               arrays = size_t{1} + (options.triangle ? 1 : 0) + (options.winding ? 1 : 0) +
                        (options.confidence ? 1 : 0);
  return samples * arrays * sizeof(float) +
         std::min(samples, parallelThreads() * LatticeQuery::kSamplesOfBlock) * LatticeQuery::kBytesPerSample;
}

Field makeRegion(const PreparedSurface& surface, const Grid& lattice, const Region& region,
                 const RegionOptions& options, Progress& progress) {
  return RegionMaker(surface, lattice, region, options, progress).make();
}

}  // namespace raymap::cpu
