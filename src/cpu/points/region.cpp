// Fields of a part of a lattice, whose samples are queried block by block. With a band, blocks that lie
// wholly beyond it cost one query each.

#include "cpu/points/region.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cpu/points/far_balls.h"
#include "cpu/points/point_query.h"

namespace raymap::cpu {

namespace {

constexpr int kSideOfBlock = 8;
/// Half the side between the outermost samples of a block.
constexpr double kHalfBlock = 0.5 * (kSideOfBlock - 1);
constexpr size_t kSamplesPerQuery = size_t{1} << 18;
/// Blocks whose sides are found together.
constexpr size_t kBlocksAtOnce = size_t{1} << 15;

class RegionMaker {
 public:
  RegionMaker(const PreparedSurface& surface, const Grid& lattice, const Region& region,
              const RegionOptions& options, Progress& progress)
      : surface_(surface),
        lattice_(lattice),
        region_(region),
        options_(options),
        progress_(progress),
        blocks_((region.size + (kSideOfBlock - 1)) / kSideOfBlock),
        balls_(surface, std::sqrt(3.0) * kHalfBlock * lattice.spacing, options.band * lattice.spacing) {
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
    const glm::ivec3 block = glm::min(region_.size, glm::ivec3(kSideOfBlock));
    const size_t perQuery = kSamplesPerQuery / (size_t(block.x) * size_t(block.y) * size_t(block.z)),
                 blocks = size_t(blocks_.x) * size_t(blocks_.y) * size_t(blocks_.z);
    for (size_t begin = 0; begin < blocks; begin += kBlocksAtOnce) {
      const size_t end = std::min(begin + kBlocksAtOnce, blocks);
      const auto share = [&](double part) { return (double(begin) + part * double(end - begin)) / double(blocks); };
      progress_.part(share(0.0), share(0.0));
      const std::vector<size_t> near = fillFar(begin, end);
      for (size_t k = 0; k < near.size(); k += perQuery) {
        const size_t count = std::min(perQuery, near.size() - k);
        progress_.part(share(double(k) / double(near.size())), share(double(k + count) / double(near.size())));
        fillNear(std::span(near).subspan(k, count));
      }
    }
  }

  /// Fills those of the blocks numbered [begin, end) that lie beyond the band. Returns the others.
  std::vector<size_t> fillFar(size_t begin, size_t end) {
    std::vector<BallSide> sides(end - begin, BallSide::Near);
    // Beyond the band, winding numbers and confidences still differ from sample to sample.
    if (options_.band > 0.0 && !options_.winding && !options_.confidence) findSides(begin, sides);
    std::vector<size_t> near;
    for (size_t b = begin; b < end; ++b)
      if (sides[b - begin] == BallSide::Near) near.push_back(b);
    parallelFor(sides.size(), 64, [&](size_t from, size_t to) {
      for (size_t b = from; b < to; ++b) {
        if (sides[b] == BallSide::Near) continue;
        const auto clamp = float(field_.clampDistance), value = sides[b] == BallSide::Inside ? -clamp : clamp;
        forEachSample(begin + b, [&](const glm::ivec3&, size_t index) {
          field_.distance[index] = value;
          if (options_.triangle) field_.triangle[index] = kNoTriangle;
        });
      }
    });
    return near;
  }

  void findSides(size_t begin, std::span<BallSide> sides) {
    std::vector<glm::dvec3> centres;
    for (size_t b = begin; b < begin + sides.size(); ++b)
      centres.push_back(lattice_.position(glm::dvec3(region_.low + lowOf(b)) + kHalfBlock));
    balls_.find(centres, progress_, sides);
  }

  void fillNear(std::span<const size_t> blocks) {
    std::vector<size_t> offsets(blocks.size() + 1, 0);
    for (size_t k = 0; k < blocks.size(); ++k) {
      const glm::ivec3 size = sizeOf(lowOf(blocks[k]));
      offsets[k + 1] = offsets[k] + size_t(size.x) * size_t(size.y) * size_t(size.z);
    }
    points_.resizeUninitialized(offsets.back());
    const auto forEachBlock = [&](auto&& visit) {
      parallelFor(blocks.size(), 64, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) visit(blocks[k], offsets[k]);
      });
    };
    forEachBlock([&](size_t block, size_t point) {
      forEachSample(block, [&](const glm::ivec3& sample, size_t) {
        points_[point++] = lattice_.position(glm::dvec3(region_.low + sample));
      });
    });
    const double most = options_.band > 0.0 ? field_.clampDistance : INFINITY;
    queryPoints(surface_, PointsView(std::span(points_)),
                {.triangle = options_.triangle,
                 .winding = options_.winding,
                 .confidence = options_.confidence,
                 .maxDistance = most},
                progress_, found_);
    forEachBlock([&](size_t block, size_t point) {
      forEachSample(block, [&](const glm::ivec3&, size_t index) { keep(point++, index); });
    });
  }

  /// Takes what was found at a point for a sample.
  void keep(size_t point, size_t index) {
    field_.distance[index] = static_cast<float>(found_.distance[point]);
    const bool isClamped =
        options_.band > 0.0 && std::abs(field_.distance[index]) >= float(field_.clampDistance);
    if (options_.triangle) field_.triangle[index] = isClamped ? kNoTriangle : found_.triangle[point];
    if (options_.winding) field_.winding[index] = found_.winding[point];
    if (options_.confidence) field_.confidence[index] = found_.confidence[point];
  }

  /// Returns a block's first sample, counted from that of the region.
  glm::ivec3 lowOf(size_t block) const {
    const size_t x = size_t(blocks_.x), y = size_t(blocks_.y);
    return kSideOfBlock * glm::ivec3(block % x, block / x % y, block / x / y);
  }
  glm::ivec3 sizeOf(const glm::ivec3& low) const {
    return glm::min(region_.size - low, glm::ivec3(kSideOfBlock));
  }

  /// Calls `visit(sample, index)` for the samples of a block, counted from that of the region.
  template <class Visit>
  void forEachSample(size_t block, Visit&& visit) const {
    const glm::ivec3 low = lowOf(block), high = low + sizeOf(low);
    for (int z = low.z; z < high.z; ++z)
      for (int y = low.y; y < high.y; ++y) {
        size_t index = field_.grid.index({low.x, y, z});
        for (int x = low.x; x < high.x; ++x) visit(glm::ivec3(x, y, z), index++);
      }
  }

  const PreparedSurface& surface_;
  const Grid& lattice_;
  const Region& region_;
  const RegionOptions& options_;
  Progress& progress_;
  glm::ivec3 blocks_;  ///< Number of blocks along each axis.
  FarBalls balls_;
  Field field_;
  Buffer<glm::dvec3> points_;
  QueryResult found_;
};

}  // namespace

size_t regionBytes(const glm::ivec3& size, const RegionOptions& options) {
  constexpr size_t kPerPoint = 96;                           // Of a query, with its results.
  constexpr size_t kMostSamples = SIZE_MAX / 2 / kPerPoint;  // More than any memory holds.
  const size_t plane = size_t(size.x) * size_t(size.y),
               samples = size_t(size.z) > kMostSamples / plane ? kMostSamples : plane * size_t(size.z),
               arrays = size_t{1} + (options.triangle ? 1 : 0) + (options.winding ? 1 : 0) +
                        (options.confidence ? 1 : 0);
  return samples * arrays * sizeof(float) + std::min(samples, kSamplesPerQuery + kBlocksAtOnce) * kPerPoint;
}

Field makeRegion(const PreparedSurface& surface, const Grid& lattice, const Region& region,
                 const RegionOptions& options, Progress& progress) {
  return RegionMaker(surface, lattice, region, options, progress).make();
}

}  // namespace raymap::cpu
