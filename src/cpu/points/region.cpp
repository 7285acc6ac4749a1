// Fields of a part of a lattice, whose samples are queried cube by cube. With a band, cubes that lie wholly
// beyond it cost one query each.

#include "cpu/points/region.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cpu/points/far_cubes.h"
#include "cpu/points/lattice_query.h"

namespace raymap::cpu {

namespace {

constexpr int kSide = LatticeQuery::kSide;
/// Cubes of 32 x 32 x 32 samples are visited one after the other.
constexpr int kSideOfBlock = 32;
/// Samples of the blocks whose cubes are asked for together: some blocks for each thread.
constexpr size_t kSamplesAtOnce = size_t{1} << 19;

class RegionMaker {
 public:
  RegionMaker(const PreparedSurface& surface, const Grid& lattice, const Region& region,
              const RegionOptions& options, Progress& progress)
      : region_(region),
        options_(options),
        progress_(progress),
        high_(region.low + region.size),
        firstBlock_(region.low / kSideOfBlock),
        blocks_((region.low + region.size - 1) / kSideOfBlock - firstBlock_ + 1),
        far_(surface, lattice, {options.band * lattice.spacing, options.band * lattice.spacing}),
        query_(surface, lattice, region,
               {.triangle = options.triangle,
                .winding = options.winding,
                .confidence = options.confidence,
                .maxDistance = options.band > 0.0 ? options.band * lattice.spacing : INFINITY}) {
    field_.grid = {region.size, lattice.position(glm::dvec3(region.low)), lattice.spacing};
    field_.clampDistance = options.band * lattice.spacing;
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
    const size_t blocks = size_t(blocks_.x) * size_t(blocks_.y) * size_t(blocks_.z);
    const glm::ivec3 most = glm::min(region_.size, glm::ivec3(kSideOfBlock));
    const size_t atATime = kSamplesAtOnce / (size_t(most.x) * size_t(most.y) * size_t(most.z));
    std::vector<AskedCube> asked;
    for (size_t begin = 0; begin < blocks; begin += atATime) {
      const size_t end = std::min(begin + atATime, blocks);
      progress_.part(double(begin) / double(blocks), double(end) / double(blocks));
      const std::vector<glm::ivec3> cubes = cubesOf(begin, end);
      const std::vector<Side> sides = sidesOf(cubes);
      asked.clear();
      for (size_t c = 0; c < cubes.size(); ++c)
        if (sides[c] == Side::Unknown)
          asked.push_back({cubes[c]});
        else
          fillFar(cubes[c], sides[c]);
      fillNear(asked);
    }
  }

  /// Returns the cubes of the blocks numbered [begin, end) that hold samples of the region, along a Morton
  /// curve in each block.
  std::vector<glm::ivec3> cubesOf(size_t begin, size_t end) const {
    std::vector<glm::ivec3> cubes;
    const size_t x = size_t(blocks_.x), y = size_t(blocks_.y);
    for (size_t b = begin; b < end; ++b) {
      const glm::ivec3 low = kSideOfBlock * (firstBlock_ + glm::ivec3(b % x, b / x % y, b / x / y));
      for (int pair = 0; pair < 8; ++pair)
        for (int one = 0; one < 8; ++one) {
          const glm::ivec3 cube = low + kSide * (2 * cornerOf(pair) + cornerOf(one));
          if (glm::all(glm::lessThan(cube, high_)) && glm::all(glm::greaterThan(cube + kSide, region_.low)))
            cubes.push_back(cube);
        }
    }
    return cubes;
  }

  /// Returns the sides of those cubes that lie beyond the band.
  std::vector<Side> sidesOf(const std::vector<glm::ivec3>& cubes) {
    std::vector<Side> sides(cubes.size(), Side::Unknown);
    // Beyond the band, winding numbers and confidences still differ from sample to sample.
    if (options_.band > 0.0 && !options_.winding && !options_.confidence)
      far_.find(cubes, kSide, progress_, sides);
    return sides;
  }

  void fillFar(const glm::ivec3& cube, Side side) {
    const auto clamp = float(field_.clampDistance), value = side == Side::Inside ? -clamp : clamp;
    const glm::ivec3 low = glm::max(cube, region_.low), high = glm::min(cube + kSide, high_);
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y) {
        const size_t first = indexOf({low.x, y, z}), count = size_t(high.x - low.x);
        std::fill_n(field_.distance.begin() + first, count, value);
        if (options_.triangle) std::fill_n(field_.triangle.begin() + first, count, kNoTriangle);
      }
  }

  void fillNear(std::span<const AskedCube> cubes) {
    query_.ask(cubes, progress_);
    parallelFor(cubes.size(), 64, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k)
        query_.visit(k, [&](const glm::ivec3& sample, size_t point) { keep(point, indexOf(sample)); });
    });
  }

  /// Takes what was found at a point for a sample.
  void keep(size_t point, size_t index) {
    const QueryResult& found = query_.answers();
    field_.distance[index] = static_cast<float>(found.distance[point]);
    const bool isClamped =
        options_.band > 0.0 && std::abs(field_.distance[index]) >= float(field_.clampDistance);
    if (options_.triangle) field_.triangle[index] = isClamped ? kNoTriangle : found.triangle[point];
    if (options_.winding) field_.winding[index] = found.winding[point];
    if (options_.confidence) field_.confidence[index] = found.confidence[point];
  }

  size_t indexOf(const glm::ivec3& sample) const { return field_.grid.index(sample - region_.low); }

  const Region& region_;
  const RegionOptions& options_;
  Progress& progress_;
  glm::ivec3 high_;                 ///< After the region's last sample.
  glm::ivec3 firstBlock_, blocks_;  ///< The first block along each axis, and their number.
  FarCubes far_;
  LatticeQuery query_;
  Field field_;
};

}  // namespace

size_t regionBytes(const glm::ivec3& size, const RegionOptions& options) {
  constexpr size_t kMostSamples = SIZE_MAX / 256;  // More than any memory holds.
  const size_t plane = size_t(size.x) * size_t(size.y),
               samples = size_t(size.z) > kMostSamples / plane ? kMostSamples : plane * size_t(size.z),
               arrays = size_t{1} + (options.triangle ? 1 : 0) + (options.winding ? 1 : 0) +
                        (options.confidence ? 1 : 0);
  return samples * arrays * sizeof(float) + std::min(samples, kSamplesAtOnce) * LatticeQuery::kBytesPerSample;
}

Field makeRegion(const PreparedSurface& surface, const Grid& lattice, const Region& region,
                 const RegionOptions& options, Progress& progress) {
  return RegionMaker(surface, lattice, region, options, progress).make();
}

}  // namespace raymap::cpu
