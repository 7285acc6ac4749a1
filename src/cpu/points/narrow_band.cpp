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
#include "base/morton.h"
#include "base/parallel.h"
#include "cpu/points/block_distances.h"
#include "cpu/points/block_sides.h"
#include "cpu/points/point_query.h"
#include "cpu/points/segment_crossings.h"
#include "field/join_tiles.h"

namespace raymap::cpu {

namespace {

constexpr int kSmallest = 4;       ///< Side of the smallest cubes.
constexpr int kSignSide = 16;      ///< Side of the cubes whose samples share signs.
constexpr int kDistanceSide = 32;  ///< Side of the cubes whose samples are measured together.
constexpr size_t kPointsAtATime = size_t{1} << 18;
/// Share by which a cube must be farther than the band, for rounding of coordinates.
constexpr double kMargin = 1e-5;
glm::ivec3 childOf(const glm::ivec3& low, int side, int child) {
  return low + side / 2 * glm::ivec3(child & 1, child >> 1 & 1, child >> 2);
}

/// A cube of 8 x 8 x 8 samples, and on which side its eight parts lie. `Side::Unknown` counts as near.
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
    band_.outside = options.outside * grid.spacing;
    band_.inside = options.inside * grid.spacing;
  }

  SparseField make(size_t most) {
    progress_.stage("find_leaves", [&] { findLeaves(); });
    const size_t arrays =
        1 + (options_.triangle ? 1 : 0) + (options_.winding ? 1 : 0) + (options_.confidence ? 1 : 0);
    constexpr size_t kPerPoint = 128;  // Of a query, with its results.
    checkFieldMemory(surface_.bytes() +
                         parts_.size() * (sizeof(glm::ivec3) + sizeof(LeafParts) +
                                          arrays * sizeof(float) * SparseField::kLeafSamples) +
                         kPointsAtATime * kPerPoint,
                     most);
    progress_.stage("fill_leaves", [&] { fillLeaves(); });
    return std::move(band_);
  }

 private:
  /// Halves the cubes that may hold samples of the band, down to the parts of leaves.
  void findLeaves() {
    const glm::ivec3 dims = band_.grid.dims;
    int side =
        std::max(int(std::bit_ceil(uint32_t(std::max({dims.x, dims.y, dims.z})))), SparseField::kLeafSide);
    std::vector<glm::ivec3> cubes{glm::ivec3(0)};
    const int levels = std::countr_zero(uint32_t(side / kSmallest));
    for (int level = 0; !cubes.empty(); ++level) {
      progress_.part(double(level) / double(levels + 1), double(level + 1) / double(levels + 1));
      const std::vector<Side> sides = sidesOf(cubes, side);
      if (side == kSmallest) {
        keepParts(cubes, sides);
        break;
      }
      std::vector<glm::ivec3> parts;
      for (size_t c = 0; c < cubes.size(); ++c) {
        if (sides[c] == Side::Inside) band_.tiles.push_back({cubes[c], side});
        if (sides[c] != Side::Unknown) continue;
        for (int child = 0; child < 8; ++child) {
          const glm::ivec3 low = childOf(cubes[c], side, child);
          // All parts of a leaf are kept, so that eight follow each other.
          if (side == SparseField::kLeafSide || glm::all(glm::lessThan(low, dims))) parts.push_back(low);
        }
      }
      cubes = std::move(parts);
      side /= 2;
    }
  }

  /// Returns the side of each cube whose samples all lie beyond the band on one side. The children of a cube
  /// follow each other.
  std::vector<Side> sidesOf(const std::vector<glm::ivec3>& cubes, int side) {
    const double radius = 0.5 * std::sqrt(3.0) * double(side - 1) * band_.grid.spacing;
    std::vector<Side> sides(cubes.size());
    const auto parentOf = [&](size_t c) { return cubes[c] / (2 * side); };
    for (size_t begin = 0, end = 0; begin < cubes.size(); begin = end) {
      end = std::min(begin + kPointsAtATime, cubes.size());
      while (end < cubes.size() && parentOf(end) == parentOf(end - 1)) ++end;
      const std::span part = std::span(cubes).subspan(begin, end - begin);
      findFar(part, side, radius, std::span(sides).subspan(begin, part.size()));
    }
    return sides;
  }

  /// Returns the width of the band on a side.
  double widthOf(Side side) const { return side == Side::Inside ? band_.inside : band_.outside; }

  void findFar(std::span<const glm::ivec3> cubes, int side, double radius, std::span<Side> sides) {
    const double slack = 2.0 * surface_.grid.spacing * double(slackOf(surface_.tree, surface_.grid.dims));
    const auto limit = [&](double width) { return (radius + width) * (1.0 + kMargin) + slack; };
    const double narrow = std::min(band_.outside, band_.inside), wide = std::max(band_.outside, band_.inside);
    points_.resizeUninitialized(cubes.size());
    for (size_t c = 0; c < cubes.size(); ++c)
      points_[c] = band_.grid.position(glm::dvec3(cubes[c]) + 0.5 * double(side - 1));
    const QueryOptions query{.maxDistance = limit(std::isfinite(wide) ? wide : narrow)};
    queryUnsigned(surface_, PointsView(std::span(points_)), query, progress_, found_);
    const std::vector<uint32_t> far =
        parallelSelect(cubes.size(), [&](uint32_t c) { return found_.distance[c] >= limit(narrow); });
    const std::vector<Side> known = sidesOfFar(cubes, side, radius, far);
    std::ranges::fill(sides, Side::Unknown);
    for (size_t k = 0; k < far.size(); ++k)
      if (found_.distance[far[k]] >= limit(widthOf(known[k]))) sides[far[k]] = known[k];
  }

  /// Returns the sides of balls without surface about the centres of some cubes, which are in `points_`.
  std::vector<Side> sidesOfFar(std::span<const glm::ivec3> cubes, int side, double radius,
                               std::span<const uint32_t> far) {
    std::vector<glm::dvec3> centres;
    std::vector<double> distances;
    std::vector<uint16_t> places;
    std::vector<size_t> begins;
    for (size_t k = 0; k < far.size(); ++k) {
      const glm::ivec3 cube = cubes[far[k]] / side;
      if (k == 0 || cube / 2 != cubes[far[k - 1]] / side / 2) begins.push_back(k);
      centres.push_back(points_[far[k]]);
      distances.push_back(found_.distance[far[k]]);
      places.push_back(uint16_t((cube.x & 1) | (cube.y & 1) << 1 | (cube.z & 1) << 2));
    }
    begins.push_back(far.size());
    std::vector<Side> sides(far.size());
    findSides(surface_, {2, double(side) * band_.grid.spacing, radius, centres, distances, places, begins},
              progress_, sides);
    return sides;
  }

  void keepParts(const std::vector<glm::ivec3>& cubes, const std::vector<Side>& sides) {
    for (size_t c = 0; c < cubes.size(); c += 8) {
      LeafParts leaf{cubes[c], {}};
      std::copy_n(sides.begin() + c, 8, leaf.sides.begin());
      if (leaf.has(Side::Unknown) || (leaf.has(Side::Inside) && leaf.has(Side::Outside)))
        parts_.push_back(leaf);
      else if (leaf.has(Side::Inside))
        band_.tiles.push_back({leaf.low, SparseField::kLeafSide});
    }
  }

  /// Fills leaves, some at a time, and keeps those that have samples of the band or of both sides.
  void fillLeaves() {
    constexpr size_t kLeavesPerQuery = kPointsAtATime / SparseField::kLeafSamples;
    const size_t values = parts_.size() * SparseField::kLeafSamples;
    band_.leaves.resizeUninitialized(parts_.size());
    band_.distance.resizeUninitialized(values);
    band_.triangle.resizeUninitialized(options_.triangle ? values : 0);
    band_.winding.resizeUninitialized(options_.winding ? values : 0);
    band_.confidence.resizeUninitialized(options_.confidence ? values : 0);
    size_t kept = 0;
    for (size_t begin = 0; begin < parts_.size(); begin += kLeavesPerQuery) {
      const size_t end = std::min(begin + kLeavesPerQuery, parts_.size());
      progress_.part(double(begin) / double(parts_.size()), double(end) / double(parts_.size()));
      fill(begin, end);
      for (size_t leaf = begin; leaf < end; ++leaf) kept = keepLeaf(leaf, kept);
    }
    shrink(kept);
    band_.tiles = joined(std::move(band_.tiles), band_.grid.dims);
  }

  /// Fills the leaves numbered [begin, end).
  void fill(size_t begin, size_t end) {
    firstLeaf_ = begin;
    begins_.assign(1, 0);
    for (size_t leaf = begin; leaf < end; ++leaf) begins_.push_back(begins_.back() + asked(leaf));
    points_.resizeUninitialized(begins_.back());
    places_.resizeUninitialized(begins_.back());
    codes_.resizeUninitialized(begins_.back());
    parallelFor(end - begin, 64, [&](size_t from, size_t to) {
      for (size_t k = from; k < to; ++k) ask(begin + k, begins_[k]);
    });
    query();
    parallelFor(end - begin, 64, [&](size_t from, size_t to) {
      for (size_t k = from; k < to; ++k)
        for (size_t i = begins_[k]; i < begins_[k + 1]; ++i)
          take(i, (begin + k) * SparseField::kLeafSamples + placeInLeaf(places_[i]));
    });
  }

  /// Queries all points of `points_`. Those near each other share their sign, but where numbers are asked
  /// for.
  void query() {
    QueryOptions query{.triangle = options_.triangle,
                       .winding = options_.winding,
                       .confidence = options_.confidence,
                       .maxDistance = std::max(band_.outside, band_.inside)};
    const PointsView points{std::span(points_)};
    if (options_.winding || options_.confidence) {
      queryPoints(surface_, points, query, progress_, found_);
      return;
    }
    measure(cubesOf(kDistanceSide), query.maxDistance);
    sides_.resizeUninitialized(points_.size());
    findSides(
        surface_,
        {kSignSide, band_.grid.spacing, 0.0, points_, found_.distance, places_, cubesOf(kSignSide).begins},
        progress_, sides_);
    parallelFor(sides_.size(), kCheapGrain, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i)
        if (sides_[i] == Side::Inside) found_.distance[i] = -found_.distance[i];
    });
    const std::vector<uint32_t> rest =
        parallelSelect(sides_.size(), [&](uint32_t i) { return sides_[i] == Side::Unknown; });
    std::vector<glm::dvec3> restPoints;
    for (const uint32_t i : rest) restPoints.push_back(points_[i]);
    QueryResult found;
    query.triangle = false;
    queryPoints(surface_, PointsView(restPoints), query, progress_, found);
    for (size_t k = 0; k < rest.size(); ++k) found_.distance[rest[k]] = found.distance[k];
  }

  /// Cubes of samples, and which points lie in each.
  struct Cubes {
    std::vector<glm::ivec3> lows;
    std::vector<size_t> begins;  // First point of each, and at last the number of points.
  };

  /// Returns the cubes with this side that hold the leaves of the query.
  Cubes cubesOf(int side) const {
    Cubes cubes;
    for (size_t k = 0; k + 1 < begins_.size(); ++k) {
      const glm::ivec3 low = parts_[firstLeaf_ + k].low / side * side;
      if (!cubes.lows.empty() && cubes.lows.back() == low) continue;
      cubes.lows.push_back(low);
      cubes.begins.push_back(begins_[k]);
    }
    cubes.begins.push_back(begins_.back());
    return cubes;
  }

  /// Finds unsigned distances and triangles, a cube at a time.
  void measure(const Cubes& cubes, double most) {
    found_.distance.resizeUninitialized(points_.size());
    found_.triangle.resizeUninitialized(points_.size());
    parallelWorkers(cubes.lows.size(), [&](const auto& next) {
      BlockDistances distances(surface_);
      for (size_t c = next(); c < cubes.lows.size(); c = next()) {
        const size_t begin = cubes.begins[c], count = cubes.begins[c + 1] - begin;
        const LatticeBlock block{band_.grid.position(glm::dvec3(cubes.lows[c])), kDistanceSide,
                                 band_.grid.spacing};
        distances.find(block, std::span(points_).subspan(begin, count),
                       std::span(codes_).subspan(begin, count), most,
                       std::span(found_.distance).subspan(begin, count),
                       std::span(found_.triangle).subspan(begin, count));
      }
    });
  }

  /// Stores what was found at a point.
  void take(size_t point, size_t place) {
    const auto value = float(std::clamp(found_.distance[point], -band_.inside, band_.outside));
    band_.distance[place] = value;
    if (options_.triangle)
      band_.triangle[place] = band_.isActive(value) ? found_.triangle[point] : kNoTriangle;
    if (options_.winding) band_.winding[place] = found_.winding[point];
    if (options_.confidence) band_.confidence[place] = found_.confidence[point];
  }

  static uint16_t placeInCube(const glm::ivec3& sample) {
    const glm::ivec3 p = sample % kSignSide;
    return uint16_t((p.z * kSignSide + p.y) * kSignSide + p.x);
  }

  static uint16_t codeInCube(const glm::ivec3& sample) {
    const glm::uvec3 p(sample % kDistanceSide);
    return uint16_t(mortonCode(p.x, p.y, p.z));
  }

  /// Returns the place in its leaf of a sample with this place in its cube.
  static size_t placeInLeaf(uint16_t place) {
    constexpr int kSide = SparseField::kLeafSide;
    const glm::ivec3 p =
        glm::ivec3(place % kSignSide, place / kSignSide % kSignSide, place / kSignSide / kSignSide) % kSide;
    return (size_t(p.z) * kSide + size_t(p.y)) * kSide + size_t(p.x);
  }

  /// Whether a part's samples are queried. Their signs are known where it is not near.
  bool isAsked(Side side) const { return side == Side::Unknown || options_.winding || options_.confidence; }

  /// Visits the samples of a part of a leaf along a Morton curve, with their places in the leaf.
  template <class Visit>
  void forEachSample(const glm::ivec3& low, int part, Visit&& visit) const {
    constexpr int kSide = SparseField::kLeafSide;
    for (int pair = 0; pair < 8; ++pair)
      for (int one = 0; one < 8; ++one) {
        const glm::ivec3 within =
            childOf(childOf(childOf(glm::ivec3(0), kSide, part), kSmallest, pair), kSmallest / 2, one);
        visit(low + within, (size_t(within.z) * kSide + size_t(within.y)) * kSide + size_t(within.x));
      }
  }

  bool isOnLattice(const glm::ivec3& sample) const {
    return glm::all(glm::lessThan(sample, band_.grid.dims));
  }

  size_t asked(size_t leaf) const {
    size_t count = 0;
    const LeafParts& parts = parts_[leaf];
    for (int part = 0; part < 8; ++part) {
      if (!isAsked(parts.sides[size_t(part)])) continue;
      const glm::ivec3 low = childOf(parts.low, SparseField::kLeafSide, part);
      const glm::ivec3 size = glm::clamp(band_.grid.dims - low, glm::ivec3(0), glm::ivec3(kSmallest));
      count += size_t(size.x) * size_t(size.y) * size_t(size.z);
    }
    return count;
  }

  /// Lists the points of a leaf that are queried, from `next` on, and fills what is known of the others.
  void ask(size_t leaf, size_t next) {
    const LeafParts& parts = parts_[leaf];
    const size_t first = leaf * SparseField::kLeafSamples;
    band_.leaves[leaf] = parts.low;
    for (int part = 0; part < 8; ++part) {
      const Side side = parts.sides[size_t(part)];
      forEachSample(parts.low, part, [&](const glm::ivec3& sample, size_t place) {
        if (isOnLattice(sample) && isAsked(side)) {
          points_[next] = band_.grid.position(glm::dvec3(sample));
          places_[next] = placeInCube(sample);
          codes_[next++] = codeInCube(sample);
          return;
        }
        const bool isInside = side == Side::Inside && isOnLattice(sample);
        band_.distance[first + place] = isInside ? -float(band_.inside) : float(band_.outside);
        if (options_.triangle) band_.triangle[first + place] = kNoTriangle;
        if (options_.winding) band_.winding[first + place] = 0.0f;
        if (options_.confidence) band_.confidence[first + place] = 0.0f;
      });
    }
  }

  /// Returns whether all samples of a leaf, which begins on the lattice, lie beyond the band on one side.
  bool isBeyondBand(size_t leaf) const {
    const glm::ivec3 low = band_.leaves[leaf];
    const float* values = band_.distance.data() + leaf * SparseField::kLeafSamples;
    const bool isInside = values[0] < 0.0f;
    const auto isLikeFirst = [&](float v) { return !band_.isActive(v) && (v < 0.0f) == isInside; };
    if (isOnLattice(low + (SparseField::kLeafSide - 1)))
      return std::all_of(values, values + SparseField::kLeafSamples, isLikeFirst);
    bool areLikeFirst = true;
    for (int part = 0; part < 8; ++part)
      forEachSample(low, part, [&](const glm::ivec3& sample, size_t place) {
        areLikeFirst &= !isOnLattice(sample) || isLikeFirst(values[place]);
      });
    return areLikeFirst;
  }

  /// Moves a leaf to where the kept ones end, unless all its samples lie beyond the band on one side. Returns
  /// where they end now.
  size_t keepLeaf(size_t leaf, size_t kept) {
    constexpr size_t kLeafSamples = SparseField::kLeafSamples;
    if (isBeyondBand(leaf)) {
      if (band_.distance[leaf * kLeafSamples] < 0.0f)
        band_.tiles.push_back({band_.leaves[leaf], SparseField::kLeafSide});
      return kept;
    }
    if (leaf != kept) {
      band_.leaves[kept] = band_.leaves[leaf];
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
    band_.leaves.resizeUninitialized(kept);
    cut(band_.distance, kept * SparseField::kLeafSamples);
    cut(band_.triangle, kept * SparseField::kLeafSamples);
    cut(band_.winding, kept * SparseField::kLeafSamples);
    cut(band_.confidence, kept * SparseField::kLeafSamples);
  }

  const PreparedSurface& surface_;
  const BandOptions& options_;
  Progress& progress_;
  SparseField band_;
  std::vector<LeafParts> parts_;
  Buffer<glm::dvec3> points_;
  Buffer<uint16_t> places_, codes_;  // In their cubes of signs, and of distances along a Morton curve.
  std::vector<size_t> begins_;       // First point of each leaf of the query, and at last their number.
  size_t firstLeaf_ = 0;             // Of the query.
  Buffer<Side> sides_;
  QueryResult found_;
};

}  // namespace

SparseField makeNarrowBand(const PreparedSurface& surface, const Grid& grid, const BandOptions& options,
                           size_t most, Progress& progress) {
  return BandMaker(surface, grid, options, progress).make(most);
}

}  // namespace raymap::cpu
