// Ours: distances near the surface alone, where Krayer & Müller 2019, §3.3, fill every cell of the grid.
//
// The lattice is one cube, which is halved where the surface may be near. The distance of a cube's centre
// tells of most cubes that no sample of theirs is near. What is near at last are cubes of 4 x 4 x 4 samples,
// and these are queried.

#include "cpu/points/narrow_band.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/memory.h"
#include "base/parallel.h"
#include "cpu/points/far_cubes.h"
#include "cpu/points/lattice_query.h"
#include "field/join_tiles.h"

namespace raymap::cpu {

namespace {

constexpr int kSmallest = LatticeQuery::kPartSide;  ///< Side of the smallest cubes.
constexpr size_t kBlocksAtATime = 4096;

glm::ivec3 childOf(const glm::ivec3& low, int side, int child) {
  return low + side / 2 * cornerOf(child);
}

/// A cube of 8 x 8 x 8 samples, and on which side its eight parts lie. `Side::Unknown` is taken as near.
struct LeafParts {
  glm::ivec3 low;
  std::array<Side, 8> sides;

  bool has(Side side) const { return std::ranges::find(sides, side) != sides.end(); }
};

class BandMaker {
 public:
  BandMaker(const PreparedSurface& surface, const Grid& grid, const BandOptions& options, Progress& progress)
      : surface_(surface), options_(options), progress_(progress) {
    band_.grid = grid;
    band_.narrow.emplace();
    band_.narrow->outside = options.outside * grid.spacing;
    band_.narrow->inside = options.inside * grid.spacing;
  }

  Field make(size_t most) {
    progress_.stage("find_leaves", [&] { findLeaves(); });
    const size_t arrays =
        1 + (options_.triangle ? 1 : 0) + (options_.winding ? 1 : 0) + (options_.confidence ? 1 : 0);
    checkFieldMemory(surface_.bytes() +
                         parts_.size() * (sizeof(glm::ivec3) + sizeof(LeafParts) +
                                          arrays * sizeof(float) * NarrowBand::kLeafSamples) +
                         parallelThreads() * LatticeQuery::kSamplesOfBlock * LatticeQuery::kBytesPerSample,
                     most);
    progress_.stage("fill_leaves", [&] { fillLeaves(); });
    return std::move(band_);
  }

 private:
  /// Halves the cubes that may hold samples of the band, down to the parts of leaves.
  void findLeaves() {
    const glm::ivec3 dims = band_.grid.dims;
    FarCubes far(surface_, band_.grid, {band_.narrow->outside, band_.narrow->inside});
    int side =
        std::max(int(std::bit_ceil(uint32_t(std::max({dims.x, dims.y, dims.z})))), NarrowBand::kLeafSide);
    std::vector<glm::ivec3> cubes{glm::ivec3(0)};
    const int levels = std::countr_zero(uint32_t(side / kSmallest));
    for (int level = 0; !cubes.empty(); ++level) {
      progress_.part(double(level) / double(levels + 1), double(level + 1) / double(levels + 1));
      std::vector<Side> sides(cubes.size());
      far.find(cubes, side, progress_, sides);
      if (side == kSmallest) {
        keepParts(cubes, sides);
        break;
      }
      std::vector<glm::ivec3> parts;
      for (size_t c = 0; c < cubes.size(); ++c) {
        if (sides[c] == Side::Inside) band_.narrow->tiles.push_back({cubes[c], side});
        if (sides[c] != Side::Unknown) continue;
        for (int child = 0; child < 8; ++child) {
          const glm::ivec3 low = childOf(cubes[c], side, child);
          // All parts of a leaf are kept, so that eight follow each other.
          if (side == NarrowBand::kLeafSide || glm::all(glm::lessThan(low, dims))) parts.push_back(low);
        }
      }
      cubes = std::move(parts);
      side /= 2;
    }
  }

  void keepParts(const std::vector<glm::ivec3>& cubes, const std::vector<Side>& sides) {
    for (size_t c = 0; c < cubes.size(); c += 8) {
      LeafParts leaf{cubes[c], {}};
      std::copy_n(sides.begin() + c, 8, leaf.sides.begin());
      if (leaf.has(Side::Unknown) || (leaf.has(Side::Inside) && leaf.has(Side::Outside)))
        parts_.push_back(leaf);
      else if (leaf.has(Side::Inside))
        band_.narrow->tiles.push_back({leaf.low, NarrowBand::kLeafSide});
    }
  }

  /// Fills leaves, some at a time, and keeps those that have samples of the band or of both sides.
  void fillLeaves() {
    const size_t values = parts_.size() * NarrowBand::kLeafSamples;
    band_.narrow->leaves.resizeUninitialized(parts_.size());
    band_.distance.resizeUninitialized(values);
    band_.triangle.resizeUninitialized(options_.triangle ? values : 0);
    band_.winding.resizeUninitialized(options_.winding ? values : 0);
    band_.confidence.resizeUninitialized(options_.confidence ? values : 0);
    const std::vector<size_t> blocks = blocksOfLeaves();
    const QueryOptions asked{.triangle = options_.triangle,
                             .winding = options_.winding,
                             .confidence = options_.confidence,
                             .maxDistance = std::max(band_.narrow->outside, band_.narrow->inside)};
    WorkMeter meter(progress_, 0.0, 1.0, double(blocks.size() - 1));
    size_t kept = 0;
    for (size_t begin = 0, end = 0; begin + 1 < blocks.size(); begin = end) {
      end = std::min(begin + kBlocksAtATime, blocks.size() - 1);
      askInBlocks(
          surface_, band_.grid, {glm::ivec3(0), band_.grid.dims}, asked, end - begin, meter,
          [&](LatticeQuery& query, size_t b) { fill(query, blocks[begin + b], blocks[begin + b + 1]); });
      for (size_t leaf = blocks[begin]; leaf < blocks[end]; ++leaf) kept = keepLeaf(leaf, kept);
    }
    shrink(kept);
    band_.narrow->tiles = joined(std::move(band_.narrow->tiles), band_.grid.dims);
  }

  /// Returns the first leaf in each cube of samples that are measured together, and at last the number of
  /// leaves.
  std::vector<size_t> blocksOfLeaves() const {
    const auto blockOf = [&](size_t leaf) { return parts_[leaf].low / LatticeQuery::kDistanceSide; };
    std::vector<size_t> begins;
    for (size_t leaf = 0; leaf < parts_.size(); ++leaf)
      if (leaf == 0 || blockOf(leaf) != blockOf(leaf - 1)) begins.push_back(leaf);
    begins.push_back(parts_.size());
    return begins;
  }

  /// Fills the leaves numbered [begin, end).
  void fill(LatticeQuery& query, size_t begin, size_t end) {
    std::vector<AskedCube> cubes;
    for (size_t leaf = begin; leaf < end; ++leaf) cubes.push_back({parts_[leaf].low, askedParts(leaf)});
    query.ask(cubes);
    for (size_t k = 0; k < cubes.size(); ++k) {
      fillKnown(begin + k);
      query.visit(k, [&](const glm::ivec3& sample, size_t point) {
        take(query.answers(), point, placeOf(begin + k, sample));
      });
    }
  }

  /// Returns the parts of a leaf whose samples are asked for. The sides of the others are known.
  uint8_t askedParts(size_t leaf) const {
    if (options_.winding || options_.confidence) return 0xff;
    uint8_t parts = 0;
    for (int part = 0; part < 8; ++part)
      if (parts_[leaf].sides[size_t(part)] == Side::Unknown) parts |= uint8_t(1 << part);
    return parts;
  }

  /// Returns the place of a sample's values.
  static size_t placeOf(size_t leaf, const glm::ivec3& sample) {
    constexpr int kSide = NarrowBand::kLeafSide;
    const glm::ivec3 p = sample % kSide;
    return leaf * NarrowBand::kLeafSamples + (size_t(p.z) * kSide + size_t(p.y)) * kSide + size_t(p.x);
  }

  bool isOnLattice(const glm::ivec3& sample) const {
    return glm::all(glm::lessThan(sample, band_.grid.dims));
  }

  /// Fills what is known of a leaf without asking.
  void fillKnown(size_t leaf) {
    const LeafParts& parts = parts_[leaf];
    band_.narrow->leaves[leaf] = parts.low;
    const auto fill = [&](auto& array, auto value) {
      if (!array.empty())
        std::fill_n(array.data() + leaf * NarrowBand::kLeafSamples, NarrowBand::kLeafSamples, value);
    };
    fill(band_.distance, float(band_.narrow->outside));
    fill(band_.triangle, kNoTriangle);
    fill(band_.winding, 0.0f);
    fill(band_.confidence, 0.0f);
    for (int part = 0; part < 8; ++part)
      if (parts.sides[size_t(part)] == Side::Inside)
        LatticeQuery::forEachOfPart(parts.low, part, [&](const glm::ivec3& sample) {
          if (isOnLattice(sample)) band_.distance[placeOf(leaf, sample)] = -float(band_.narrow->inside);
        });
  }

  /// Stores what was found at a point.
  void take(const QueryResult& found, size_t point, size_t place) {
    const auto value = float(std::clamp(found.distance[point], -band_.narrow->inside, band_.narrow->outside));
    band_.distance[place] = value;
    if (options_.triangle)
      band_.triangle[place] = band_.narrow->isActive(value) ? found.triangle[point] : kNoTriangle;
    if (options_.winding) band_.winding[place] = found.winding[point];
    if (options_.confidence) band_.confidence[place] = found.confidence[point];
  }

  /// Returns whether all samples of a leaf, which begins on the lattice, lie beyond the band on one side.
  bool isBeyondBand(size_t leaf) const {
    const glm::ivec3 low = band_.narrow->leaves[leaf];
    const float* values = band_.distance.data() + leaf * NarrowBand::kLeafSamples;
    const bool isInside = values[0] < 0.0f;
    const auto isLikeFirst = [&](float v) { return !band_.narrow->isActive(v) && (v < 0.0f) == isInside; };
    if (isOnLattice(low + (NarrowBand::kLeafSide - 1)))
      return std::all_of(values, values + NarrowBand::kLeafSamples, isLikeFirst);
    bool areLikeFirst = true;
    for (int part = 0; part < 8; ++part)
      LatticeQuery::forEachOfPart(low, part, [&](const glm::ivec3& sample) {
        areLikeFirst &= !isOnLattice(sample) || isLikeFirst(values[placeOf(0, sample)]);
      });
    return areLikeFirst;
  }

  /// Moves a leaf to where the kept ones end, unless all its samples lie beyond the band on one side. Returns
  /// where they end now.
  size_t keepLeaf(size_t leaf, size_t kept) {
    constexpr size_t kLeafSamples = NarrowBand::kLeafSamples;
    if (isBeyondBand(leaf)) {
      if (band_.distance[leaf * kLeafSamples] < 0.0f)
        band_.narrow->tiles.push_back({band_.narrow->leaves[leaf], NarrowBand::kLeafSide});
      return kept;
    }
    if (leaf != kept) {
      band_.narrow->leaves[kept] = band_.narrow->leaves[leaf];
      const auto move = [&](auto& array) {
        if (!array.empty())
          std::copy_n(array.data() + leaf * kLeafSamples, kLeafSamples, array.data() + kept * kLeafSamples);
      };
      move(band_.distance);
      move(band_.triangle);
      move(band_.winding);
      move(band_.confidence);
    }
    return kept + 1;
  }

  void shrink(size_t kept) {
    const auto cut = [&](auto& array, size_t size) {
      if (!array.empty()) array.resizeUninitialized(size);
    };
    band_.narrow->leaves.resizeUninitialized(kept);
    cut(band_.distance, kept * NarrowBand::kLeafSamples);
    cut(band_.triangle, kept * NarrowBand::kLeafSamples);
    cut(band_.winding, kept * NarrowBand::kLeafSamples);
    cut(band_.confidence, kept * NarrowBand::kLeafSamples);
  }

  const PreparedSurface& surface_;
  const BandOptions& options_;
  Progress& progress_;
  Field band_;
  std::vector<LeafParts> parts_;
};

}  // namespace

Field makeNarrowBand(const PreparedSurface& surface, const Grid& grid, const BandOptions& options,
                     size_t most, Progress& progress) {
  return BandMaker(surface, grid, options, progress).make(most);
}

}  // namespace raymap::cpu
