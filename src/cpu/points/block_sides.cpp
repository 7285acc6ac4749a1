// Ours: signs of lattice points near each other, where Krayer & Müller 2019, §3.5, send rays from every
// sample.
//
// A ball about a point, as large as its distance, holds no surface. Where the balls of two points meet, the
// winding number changes between the points by what the rims say alone: by its slope, within a bound. So one
// point tells the sides of all that such balls join.

#include "cpu/points/block_sides.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>

#include "base/parallel.h"
#include "cpu/points/point_query.h"
#include "cpu/points/segment_crossings.h"
#include "method/winding_paths_offsets.h"
#include "method/winding_rims_shared.h"

namespace raymap::cpu {

namespace {

/// Larger than the error of any winding number of a query: up to 4,096 rims, and beyond.
constexpr double kExactNumberError = 1e-5, kDipoleNumberError = 1e-3;

constexpr size_t kMostPlaces =
    size_t(BlockPoints::kMostSide) * BlockPoints::kMostSide * BlockPoints::kMostSide;

/// Joins the points of one cube. Each thread has its own instance.
class JoinedPoints {
 public:
  explicit JoinedPoints(int side) : side_(side), count_(size_t(side) * size_t(side) * size_t(side)) {}

  /// Finds for each point of a cube the first one, from `begin` on, that it is joined to. Balls must overlap
  /// by `overlap` to count.
  void join(const BlockPoints& blocks, size_t begin, size_t end, double overlap, std::span<uint32_t> firsts) {
    std::fill_n(distances_.begin(), count_, -INFINITY);
    for (size_t k = begin; k < end; ++k) distances_[blocks.places[k]] = blocks.distances[k];
    const double needed = blocks.spacing + overlap;
    const auto side = size_t(side_);
    for (size_t row = 0; row < side * side; ++row) {
      const size_t p = row * side;
      const uint32_t along = overlapping(p + 1, p, side - 1, needed) << 1;
      for (size_t x = 0; x < side; ++x) roots_[p + x] = along >> x & 1 ? roots_[p + x - 1] : uint16_t(p + x);
      along_[row] = along;
      if (row % side > 0) joinRows(row, row - 1, needed);
      if (row >= side) joinRows(row, row - side, needed);
    }
    std::fill_n(chosen_.begin(), count_, kNone);
    for (size_t k = begin; k < end; ++k) {
      uint32_t& first = chosen_[rootOf(blocks.places[k])];
      if (first == kNone) first = uint32_t(k);
      firsts[k] = first;
    }
  }

 private:
  static constexpr uint32_t kNone = 0xffffffffu;

  uint16_t rootOf(size_t p) {
    while (roots_[p] != p) p = roots_[p] = roots_[roots_[p]];
    return uint16_t(p);
  }

  /// Returns which of `count` balls from p on overlap those from q on.
  uint32_t overlapping(size_t p, size_t q, size_t count, double needed) const {
    uint32_t bits = 0;
    for (size_t x = 0; x < count; ++x) bits |= uint32_t(distances_[p + x] + distances_[q + x] > needed) << x;
    return bits;
  }

  /// Joins the points of two rows, once for each run that is joined in both.
  void joinRows(size_t row, size_t before, double needed) {
    const auto side = size_t(side_);
    const uint32_t across = overlapping(row * side, before * side, side, needed);
    for (uint32_t rest = across & ~(across << 1 & along_[row] & along_[before]); rest; rest &= rest - 1) {
      const auto x = size_t(std::countr_zero(rest));
      const uint16_t a = rootOf(row * side + x), b = rootOf(before * side + x);
      roots_[std::max(a, b)] = std::min(a, b);
    }
  }

  int side_;
  size_t count_;
  std::array<double, kMostPlaces> distances_;
  std::array<uint16_t, kMostPlaces> roots_;
  /// Bit x of each row: whether its ball x overlaps ball x - 1.
  std::array<uint32_t, size_t(BlockPoints::kMostSide) * BlockPoints::kMostSide> along_;
  std::array<uint32_t, kMostPlaces> chosen_;
};

/// A winding number and how far it may be wrong.
struct Number {
  double winding, doubt;
};

/// Computes the number of a point that is joined to one of nearly this number. What the rims add to the
/// crossings of any ray is known, and these are whole.
Number numberNear(const PreparedSurface& surface, const glm::dvec3& point, double near) {
  constexpr double kAllowed = 1e-3, kExact = 1e-9;
  const Grid& grid = surface.lattice.grid;
  const glm::dvec3 fromCentre = point - grid.position(0.5 * glm::dvec3(grid.dims - 1));
  const glm::dvec3 p = point - surface.mesh.origin;
  for (uint32_t i = 0; i < uint32_t(kRays); ++i) {
    const uint32_t ray = rayToTry(i, glm::vec3(fromCentre));
    glm::dvec3 direction(0.0);
    direction[int(ray % 3)] = ray < 3 ? 1.0 : -1.0;
    const auto numberOf = [&](const RimShare& share) {
      return share.winding + std::round(near - share.winding);
    };
    const RimShare share = surface.rims.at(p, direction, kAllowed);
    if (share.clearance < double(kLeastClearance)) continue;
    const double number = numberOf(share);
    if (std::abs(std::abs(number) - surface.threshold) > 2.0 * kAllowed) return {number, kAllowed};
    return {numberOf(surface.rims.at(p, direction)), kExact};
  }
  return {near, INFINITY};
}

/// Returns some of the points.
std::vector<glm::dvec3> pointsOf(const BlockPoints& blocks, std::span<const uint32_t> which) {
  std::vector<glm::dvec3> points;
  for (const uint32_t k : which) points.push_back(blocks.points[k]);
  return points;
}

class SideFinder {
 public:
  /// `near` has a number within `kWhole` of each point's, or NaN.
  SideFinder(const PreparedSurface& surface, const BlockPoints& blocks, std::span<const double> near,
             Progress& progress, std::span<Side> sides)
      : surface_(surface), blocks_(blocks), near_(near), progress_(progress), sides_(sides) {}

  void find() {
    joinAll();
    std::ranges::fill(sides_, Side::Unknown);
    numbers_.assign(firsts_.size(), NAN);
    ask(parallelSelect(firsts_.size(),
                       [&](uint32_t k) { return firsts_[k] == k && changes_[cubes_[k]].bend < kWhole; }));
    parallelFor(firsts_.size(), kCheapGrain, [&](size_t from, size_t to) {
      for (size_t k = from; k < to; ++k)
        if (firsts_[k] != k) sides_[k] = sides_[firsts_[k]];
    });
    parallelFor(firsts_.size(), kCheapGrain, [&](size_t from, size_t to) {
      for (size_t k = from; k < to; ++k)
        if (sides_[k] == Side::Unknown) sides_[k] = decided(numberAt(k), doubtAt(k));
    });
    if (blocks_.side > 1 && (blocks_.reach > 0.0 || hasExactNumbers())) findRest();
  }

 private:
  /// Numbers that are closer than this to each other tell which whole number lies between.
  static constexpr double kWhole = 0.45;
  /// Numbers that are less exact are not kept.
  static constexpr double kMostDoubt = 1e-2;

  void joinAll() {
    // Exceeds the errors of two distances.
    const double overlap = 2.0 * surface_.grid.spacing * double(slackOf(surface_.tree, surface_.grid.dims));
    firsts_.resize(blocks_.points.size());
    cubes_.resize(blocks_.points.size());
    changes_.resize(blocks_.begins.size() - 1);
    parallelFor(blocks_.begins.size() - 1, 64, [&](size_t from, size_t to) {
      JoinedPoints joined(blocks_.side);
      for (size_t cube = from; cube < to; ++cube) {
        const size_t begin = blocks_.begins[cube], end = blocks_.begins[cube + 1];
        joined.join(blocks_, begin, end, overlap, firsts_);
        std::fill(cubes_.begin() + ptrdiff_t(begin), cubes_.begin() + ptrdiff_t(end), uint32_t(cube));
        changes_[cube] = changeIn(begin);
      }
    });
  }

  /// Finds the sides of all that some points are joined to, the quickest way first.
  void ask(std::span<const uint32_t> which) {
    std::vector<uint32_t> rest;
    const auto takeRest = [&](std::span<const uint32_t> from) {
      std::vector<uint32_t> left;
      std::ranges::copy_if(from, std::back_inserter(left),
                           [&](uint32_t k) { return sides_[k] == Side::Unknown && std::isnan(numbers_[k]); });
      rest = std::move(left);
    };
    decide(which, [&](size_t i) { return known(which[i]); });
    takeRest(which);
    // A point alone is as well queried by the caller.
    if (rest.empty() || (blocks_.side == 1 && blocks_.reach == 0.0)) return;
    if (surface_.rims.count() <= kFewRims) {  // With more, few numbers are quick.
      DoubtfulNumbers quick;
      queryNumbers(surface_, PointsView(pointsOf(blocks_, rest)), progress_, quick);
      decide(rest, [&](size_t i) { return Number{quick.winding[i], quick.doubt[i]}; });
      takeRest(std::vector(rest));
      if (rest.empty()) return;
    }
    QueryResult exact;
    queryPoints(surface_, PointsView(pointsOf(blocks_, rest)), {.distance = false, .winding = true},
                progress_, exact);
    const double error = hasExactNumbers() ? kExactNumberError : kDipoleNumberError;
    decide(rest, [&](size_t i) { return Number{double(exact.winding[i]), error}; });
  }

  /// Returns what follows from a number of the larger cube.
  Number known(uint32_t point) const {
    if (std::isnan(near_[point]) || !hasExactNumbers()) return {0.0, INFINITY};
    return numberNear(surface_, blocks_.points[point], near_[point]);
  }

  /// Stores the sides that follow from the numbers of some points.
  template <class NumberOf>
  void decide(std::span<const uint32_t> which, NumberOf&& numberOf) {
    parallelFor(which.size(), 64, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) sides_[which[i]] = sideOf(which[i], numberOf(i));
    });
  }

  /// Returns the side of a number that may be wrong by some doubt.
  Side decided(double number, double doubt) const {
    if (!(std::abs(std::abs(number) - surface_.threshold) > doubt)) return Side::Unknown;
    return std::abs(number) > surface_.threshold ? Side::Inside : Side::Outside;
  }

  /// Returns the side of all that a point is joined to, and keeps its number if theirs follow from it.
  Side sideOf(uint32_t point, const Number& number) {
    const auto& [slope, bend] = changes_[cubes_[point]];
    const double change = 2.0 * radius() * glm::length(slope) + bend;
    const Side side = decided(number.winding, change + number.doubt);
    if (side == Side::Unknown && number.doubt < kMostDoubt && bend + kMostDoubt < kWhole)
      numbers_[point] = number.winding;
    return side;
  }

  /// Returns the number of a point that follows from that of the point it is joined to, or NaN.
  double numberAt(size_t point) const {
    const size_t first = firsts_[point];
    const glm::dvec3 way = blocks_.points[point] - blocks_.points[first];
    return numbers_[first] + glm::dot(changes_[cubes_[point]].slope, way);
  }

  /// Returns how far that may be wrong within the point's reach.
  double doubtAt(size_t point) const {
    const auto& [slope, bend] = changes_[cubes_[point]];
    return kMostDoubt + bend + blocks_.reach * glm::length(slope);
  }

  /// Returns whether the rims tell numbers exactly. Else dipoles do, which cost as much for each of many
  /// points.
  bool hasExactNumbers() const { return surface_.rims.count() <= kExactRims; }

  /// Returns whether winding numbers are whole, so that they change at the surface alone.
  bool isWhole() const { return surface_.lattice.isWhole(); }

  /// Returns the radius of a ball about a cube and what its points reach.
  double radius() const {
    return 0.5 * std::sqrt(3.0) * double(blocks_.side - 1) * blocks_.spacing + blocks_.reach;
  }

  /// Returns how the number changes in that ball of the cube that has a point.
  RimChange changeIn(size_t point) const {
    if (isWhole() || radius() == 0.0) return {};
    const glm::dvec3 toMiddle = 0.5 * double(blocks_.side - 1) - glm::dvec3(placeOf(point));
    const glm::dvec3 centre = blocks_.points[point] + blocks_.spacing * toMiddle;
    return surface_.rims.changeIn(centre - surface_.mesh.origin, radius());
  }

  /// Returns the place of a point in its cube, along each axis.
  glm::ivec3 placeOf(size_t point) const {
    const int side = blocks_.side, place = blocks_.places[point];
    return {place % side, place / side % side, place / side / side};
  }

  /// Asks again for what is not known, in smaller cubes.
  void findRest() {
    const Halved rest = halve();
    if (rest.points.empty()) return;
    std::vector<Side> found(rest.points.size());
    const BlockPoints blocks{blocks_.side / 2, blocks_.spacing, blocks_.reach, rest.points,
                             rest.distances,   rest.places,     rest.begins};
    SideFinder(surface_, blocks, rest.near, progress_, found).find();
    for (size_t k = 0; k < found.size(); ++k) sides_[rest.which[k]] = found[k];
  }

  /// Some points, in smaller cubes.
  struct Halved {
    std::vector<uint32_t> which;
    std::vector<glm::dvec3> points;
    std::vector<double> distances, near;
    std::vector<uint16_t> places;
    std::vector<size_t> begins;
  };

  /// Returns the points whose side is not known.
  Halved halve() const {
    Halved halved;
    const int side = blocks_.side / 2;
    std::array<std::vector<uint32_t>, 8> halves;
    for (size_t cube = 0; cube + 1 < blocks_.begins.size(); ++cube) {
      for (size_t k = blocks_.begins[cube]; k < blocks_.begins[cube + 1]; ++k) {
        if (sides_[k] != Side::Unknown) continue;
        const glm::ivec3 half = placeOf(k) / side;
        halves[size_t(half.x) + 2 * size_t(half.y) + 4 * size_t(half.z)].push_back(uint32_t(k));
      }
      for (std::vector<uint32_t>& half : halves) {
        if (!half.empty()) halved.begins.push_back(halved.which.size());
        halved.which.insert(halved.which.end(), half.begin(), half.end());
        half.clear();
      }
    }
    halved.begins.push_back(halved.which.size());
    for (const uint32_t k : halved.which) {
      const glm::ivec3 p = placeOf(k) % side;
      halved.points.push_back(blocks_.points[k]);
      halved.distances.push_back(blocks_.distances[k]);
      halved.near.push_back(numberAt(k));
      halved.places.push_back(uint16_t((p.z * side + p.y) * side + p.x));
    }
    return halved;
  }

  const PreparedSurface& surface_;
  const BlockPoints& blocks_;
  std::span<const double> near_;
  Progress& progress_;
  std::span<Side> sides_;
  std::vector<uint32_t> firsts_;  // Of each point, the first of its cube that it is joined to.
  std::vector<uint32_t> cubes_;
  std::vector<RimChange> changes_;  // In the ball about each cube, and what its points reach.
  std::vector<double> numbers_;  // Of first points, if the numbers of all joined ones follow within `kWhole`.
};

}  // namespace

void findSides(const PreparedSurface& surface, const BlockPoints& blocks, Progress& progress,
               std::span<Side> sides) {
  if (!surface.isSigned) {
    std::ranges::fill(sides, Side::Outside);
    return;
  }
  const std::vector<double> near(blocks.points.size(), NAN);
  SideFinder(surface, blocks, near, progress, sides).find();
}

}  // namespace raymap::cpu
