// The narrow band of a scene: the lattice is one cube, which is halved where the surface may be near.

#include "api/scene_band.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/memory.h"
#include "field/join_tiles.h"

namespace raymap {

namespace {

constexpr int kSide = NarrowBand::kLeafSide;
constexpr size_t kSamples = NarrowBand::kLeafSamples, kCubesAtATime = size_t{1} << 15,
                 kLeavesAtATime = size_t{1} << 11;

/// A cube must be farther than the band by this share, as poses are not quite rigid, and coordinates are
/// rounded.
constexpr double kMargin = 1e-4;

class SceneBand {
 public:
  SceneBand(const Grid& grid, const BandOptions& options, const SceneBounds& bounds, Progress& progress)
      : bounds_(bounds), progress_(progress) {
    band_.grid = grid;
    band_.narrow.emplace();
    band_.narrow->outside = options.outside * grid.spacing;
    band_.narrow->inside = options.inside * grid.spacing;
  }

  Field make(size_t most) {
    std::vector<glm::ivec3> leaves;
    progress_.stage("find_leaves", [&] { leaves = findLeaves(); });
    checkFieldMemory(leaves.size() * (sizeof(glm::ivec3) + sizeof(float) * kSamples), most);
    progress_.stage("fill_leaves", [&] { fillLeaves(leaves); });
    band_.narrow->tiles = joined(std::move(band_.narrow->tiles), band_.grid.dims);
    return std::move(band_);
  }

 private:
  /// Halves the cubes that may hold samples of the band, down to leaves.
  std::vector<glm::ivec3> findLeaves() {
    const glm::ivec3 dims = band_.grid.dims;
    int side = std::max(int(std::bit_ceil(uint32_t(std::max({dims.x, dims.y, dims.z})))), kSide);
    std::vector<glm::ivec3> cubes{glm::ivec3(0)};
    for (;; side /= 2) {
      progress_.report(1.0 / double(side));
      std::vector<glm::ivec3> near;
      for (size_t begin = 0; begin < cubes.size(); begin += kCubesAtATime) {
        const size_t count = std::min(kCubesAtATime, cubes.size() - begin);
        leaveOutFar(std::span(cubes).subspan(begin, count), side, near);
      }
      if (side == kSide || near.empty()) return near;
      cubes.clear();
      for (const glm::ivec3& cube : near)
        for (int child = 0; child < 8; ++child) {
          const glm::ivec3 low = cube + side / 2 * glm::ivec3(child & 1, child >> 1 & 1, child >> 2);
          if (glm::all(glm::lessThan(low, dims))) cubes.push_back(low);
        }
    }
  }

  /// Adds the cubes that may hold samples of the band, and makes tiles of those inside.
  void leaveOutFar(std::span<const glm::ivec3> cubes, int side, std::vector<glm::ivec3>& near) {
    const double radius = 0.5 * std::sqrt(3.0) * double(side - 1) * band_.grid.spacing;
    const auto limit = [&](double width) { return (radius + width) * (1.0 + kMargin) + bounds_.slack; };
    const double outside = limit(band_.narrow->outside), inside = limit(band_.narrow->inside);
    std::vector<glm::dvec3> centres;
    for (const glm::ivec3& cube : cubes)
      centres.push_back(band_.grid.position(glm::dvec3(cube) + 0.5 * double(side - 1)));
    const Buffer<double> found =
        bounds_.steadyDistances(centres, std::isfinite(inside) ? std::max(outside, inside) : outside);
    for (size_t c = 0; c < cubes.size(); ++c) {
      if (std::isfinite(inside) && found[c] <= -inside)
        band_.narrow->tiles.push_back({cubes[c], side});
      else if (!(found[c] >= outside && bounds_.lowerBound(centres[c], radius) > band_.narrow->outside))
        near.push_back(cubes[c]);
    }
  }

  /// Asks for the samples of leaves, some at a time, and keeps the leaves that have samples of the band or of
  /// both sides.
  void fillLeaves(const std::vector<glm::ivec3>& leaves) {
    const double most = std::max(band_.narrow->outside, band_.narrow->inside);
    band_.narrow->leaves.resizeUninitialized(leaves.size());
    band_.distance.resizeUninitialized(leaves.size() * kSamples);
    size_t kept = 0;
    std::vector<glm::dvec3> points(std::min(leaves.size(), kLeavesAtATime) * kSamples);
    for (size_t begin = 0; begin < leaves.size(); begin += kLeavesAtATime) {
      const size_t count = std::min(kLeavesAtATime, leaves.size() - begin);
      for (size_t i = 0; i < count * kSamples; ++i)
        points[i] = band_.grid.position(glm::dvec3(sampleOf(leaves[begin + i / kSamples], i % kSamples)));
      const Buffer<double> found = bounds_.distances(std::span(points).first(count * kSamples), most);
      for (size_t l = 0; l < count; ++l) kept += keepLeaf(leaves[begin + l], &found[l * kSamples], kept);
      progress_.report(double(begin + count) / double(leaves.size()));
    }
    band_.narrow->leaves.resizeUninitialized(kept);
    band_.distance.resizeUninitialized(kept * kSamples);
  }

  static glm::ivec3 sampleOf(const glm::ivec3& leaf, size_t i) {
    const int k = int(i);
    return leaf + glm::ivec3(k % kSide, k / kSide % kSide, k / (kSide * kSide));
  }

  /// Writes a leaf to a place unless all its samples lie beyond the band on one side. Returns whether it did.
  bool keepLeaf(const glm::ivec3& leaf, const double* found, size_t place) {
    float* values = band_.distance.data() + place * kSamples;
    bool isActive = false, hasInside = false, hasOutside = false;
    for (size_t i = 0; i < kSamples; ++i) {
      values[i] = float(band_.narrow->outside);
      if (!glm::all(glm::lessThan(sampleOf(leaf, i), band_.grid.dims))) continue;
      const double distance = std::isnan(found[i]) ? band_.narrow->outside : found[i];
      values[i] = float(std::clamp(distance, -band_.narrow->inside, band_.narrow->outside));
      isActive |= band_.narrow->isActive(values[i]);
      (values[i] < 0.0f ? hasInside : hasOutside) = true;
    }
    if (!isActive && !(hasInside && hasOutside)) {
      if (hasInside) band_.narrow->tiles.push_back({leaf, kSide});
      return false;
    }
    band_.narrow->leaves[place] = leaf;
    return true;
  }

  const SceneBounds& bounds_;
  Progress& progress_;
  Field band_;
};

}  // namespace

Field makeSceneBand(const Grid& grid, const BandOptions& options, const SceneBounds& bounds, size_t most,
                    Progress& progress) {
  return SceneBand(grid, options, bounds, progress).make(most);
}

}  // namespace raymap
