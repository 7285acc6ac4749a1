// Fields of a part of a lattice, whose samples are queried block by block, one thread a block. With a band,
// cubes of any size that lie wholly beyond it cost one query each.

#include "cpu/points/region.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cpu/points/far_cubes.h"

namespace raymap::cpu {

namespace {

constexpr int kSide = LatticeQuery::kSide;

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
        band_{options.band * lattice.spacing, options.band * lattice.spacing} {
    field_.grid = {region.size, lattice.position(glm::dvec3(region.low)), lattice.spacing};
    field_.clampDistance = band_.outside;
    field_.surfaceBounds = surface.bounds;
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
    const std::vector<Cube> blocks = listBlocks();
    WorkMeter meter(progress_, 0.0, 1.0, double(blocks.size()));
    const QueryOptions options{.triangle = options_.triangle,
                               .winding = options_.winding,
                               .confidence = options_.confidence,
                               .maxDistance = options_.band > 0.0 ? band_.outside : INFINITY};
    askInBlocks(surface_, lattice_, region_, options, blocks.size(), meter,
                [&](LatticeQuery& query, size_t b) {
                  const auto& [low, at] = blocks[b];
                  if (at == Side::Unknown)
                    fillNear(query, low);
                  else
                    fillFar(low, kRegionBlock, at);
                });
  }

  /// A cube of samples, and where they lie if they lie beyond the band.
  struct Cube {
    glm::ivec3 low;
    Side at;
  };

  /// Returns the blocks with samples of the region. One cube that holds the region is halved again and again.
  std::vector<Cube> listBlocks() const {
    int side = kRegionBlock;
    while (region_.low / side != (high_ - 1) / side) side *= 2;
    std::vector<Cube> cubes{{region_.low / side * side, Side::Unknown}};
    for (;; side /= 2) {
      findFar(cubes, side);
      if (side == kRegionBlock) return cubes;
      std::vector<Cube> halves;
      for (const Cube& cube : cubes)
        for (int one = 0; one < 8; ++one)
          if (const glm::ivec3 low = cube.low + side / 2 * cornerOf(one); isInRegion(low, side / 2))
            halves.push_back({low, cube.at});
      cubes = std::move(halves);
    }
  }

  /// Finds which of the cubes that are not known to be far are far.
  void findFar(std::span<Cube> cubes, int side) const {
    std::vector<glm::ivec3> lows;
    for (const Cube& cube : cubes)
      if (cube.at == Side::Unknown) lows.push_back(cube.low);
    const std::vector<Side> found = sidesOf(lows, side);
    size_t k = 0;
    for (Cube& cube : cubes)
      if (cube.at == Side::Unknown) cube.at = found[k++];
  }

  std::vector<Side> sidesOf(std::span<const glm::ivec3> cubes, int side) const {
    std::vector<Side> sides(cubes.size(), Side::Unknown);
    Progress quiet;
    if (hasFarCubes()) FarCubes(surface_, lattice_, band_).find(cubes, side, quiet, sides);
    return sides;
  }

  bool isInRegion(const glm::ivec3& cube, int side) const {
    return glm::all(glm::lessThan(cube, high_)) && glm::all(glm::greaterThan(cube + side, region_.low));
  }

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
  glm::ivec3 high_;  ///< After the region's last sample.
  BandWidths band_;
  Field field_;
};

void RegionMaker::fillNear(LatticeQuery& query, const glm::ivec3& block) {
  std::vector<glm::ivec3> cubes;
  for (int c = 0; c < 64; ++c)
    if (const glm::ivec3 cube = block + kSide * placeInBlock(c); isInRegion(cube, kSide))
      cubes.push_back(cube);
  const std::vector<Side> sides = sidesOf(cubes, kSide);
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

std::optional<double> farDistance(const PreparedSurface& surface, const Grid& lattice, const Region& region,
                                  double band) {
  const glm::ivec3 last = region.low + region.size - 1;
  int side = 1;
  while (glm::any(glm::greaterThan(last / side - region.low / side, glm::ivec3(1)))) side *= 2;
  std::vector<glm::ivec3> cubes;
  for (int one = 0; one < 8; ++one)
    if (const glm::ivec3 cube = region.low / side + cornerOf(one);
        glm::all(glm::lessThanEqual(cube, last / side)))
      cubes.push_back(side * cube);
  std::vector<Side> sides(cubes.size(), Side::Unknown);
  const double width = band * lattice.spacing;
  Progress quiet;
  FarCubes(surface, lattice, {width, width}).find(cubes, side, quiet, sides);
  if (sides[0] == Side::Unknown || std::ranges::any_of(sides, [&](Side s) { return s != sides[0]; }))
    return std::nullopt;
  return sides[0] == Side::Inside ? -width : width;
}

Field makeRegion(const PreparedSurface& surface, const Grid& lattice, const Region& region,
                 const RegionOptions& options, Progress& progress) {
  return RegionMaker(surface, lattice, region, options, progress).make();
}

}  // namespace raymap::cpu
