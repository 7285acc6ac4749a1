// Ours: signs of lattice points near each other, where Krayer & Müller 2019, §3.5, send rays from every
// sample.
//
// A ball about a point, as large as its distance, holds no surface. Where the balls of two points meet, the
// winding number changes between the points by what the rims say alone: by its slope, within a bound. So one
// point tells the sides of all that such balls join. Close to the surface few balls meet. There the faces
// between two neighbours tell how their numbers differ, too.

#include "cpu/points/block_sides.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <iterator>

#include "base/parallel.h"
#include "cpu/points/face_crossings.h"
#include "cpu/points/point_cells.h"
#include "cpu/points/segment_crossings.h"
#include "method/winding_paths_offsets.h"
#include "method/winding_rims_shared.h"

namespace raymap::cpu {

namespace {

/// Larger than the errors of winding numbers: of any that is computed for a side, and of exact ones.
constexpr double kNumberError = PointWinding::kSideError, kExactNumberError = 1e-5;

constexpr size_t kMostPlaces =
    size_t(BlockPoints::kMostSide) * BlockPoints::kMostSide * BlockPoints::kMostSide;

/// Joins the points of one cube. Each thread has its own instance.
class JoinedPoints {
 public:
  explicit JoinedPoints(int side) : side_(side), count_(size_t(side) * size_t(side) * size_t(side)) {}

  /// Finds for each point of a cube, from `begin` on, the farthest of those it is joined to. Balls must
  /// overlap by `overlap` to count.
  void join(const BlockPoints& blocks, size_t begin, size_t end, double overlap,
            std::span<uint32_t> farthest) {
    std::fill_n(distances_.begin(), count_, -INFINITY);
    for (size_t k = begin; k < end; ++k) {
      distances_[blocks.places[k]] = blocks.distances[k];
      points_[blocks.places[k]] = uint32_t(k);
    }
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
      const uint16_t root = rootOf(blocks.places[k]);
      farthest[k] = root;
      uint32_t& chosen = chosen_[root];
      if (chosen == kNone || blocks.distances[k] > blocks.distances[chosen]) chosen = uint32_t(k);
    }
    for (size_t k = begin; k < end; ++k) farthest[k] = chosen_[farthest[k]];
  }

  /// Returns the farthest neighbour along an axis of the point at a place of that cube, or the point itself
  /// if none is farther from the surface.
  uint32_t farthestNeighbour(size_t place) const {
    size_t best = place;
    for (size_t axis = 0, step = 1; axis < 3; ++axis, step *= size_t(side_)) {
      const size_t along = place / step % size_t(side_);
      if (along > 0 && distances_[place - step] > distances_[best]) best = place - step;
      if (along + 1 < size_t(side_) && distances_[place + step] > distances_[best]) best = place + step;
    }
    return points_[best];
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
  std::array<uint32_t, kMostPlaces> chosen_, points_;
};

/// A winding number and how far it may be wrong.
struct Number {
  double winding, doubt;
};

/// Computes the number of a point that is joined to one of nearly this number. What the rims add to the
/// crossings of any ray is known, and these are whole.
Number numberNear(const PreparedSurface& surface, const glm::dvec3& point, double near) {
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
    const RimShare share = surface.rims.at(p, direction, kNumberError);
    if (share.clearance < double(kLeastClearance)) continue;
    const double number = numberOf(share);
    if (std::abs(std::abs(number) - surface.threshold) > 2.0 * kNumberError) return {number, kNumberError};
    return {numberOf(surface.rims.at(p, direction)), kExactNumberError};
  }
  return {near, INFINITY};
}

class SideFinder {
 public:
  /// `near` has a number within `kWhole` of each point's, or NaN.
  SideFinder(const PreparedSurface& surface, const BlockPoints& blocks, std::span<const double> near,
             std::span<Side> sides)
      : surface_(surface),
        blocks_(blocks),
        near_(near),
        sides_(sides),
        slack_(slackOf(surface.tree, surface.grid.dims)) {}

  void find() {
    joinAll();
    std::ranges::fill(sides_, Side::Unknown);
    numbers_.assign(farthest_.size(), {0.0, INFINITY});
    ask(parallelSelect(farthest_.size(), [&](uint32_t k) { return isAsked(k) && neighbours_[k] == k; }));
    cross();
    ask(parallelSelect(farthest_.size(), [&](uint32_t k) { return isAsked(k) && isOpen(k); }));
    parallelFor(farthest_.size(), kCheapGrain, [&](size_t from, size_t to) {
      for (size_t k = from; k < to; ++k)
        if (farthest_[k] != k) sides_[k] = sides_[farthest_[k]];
    });
    parallelFor(farthest_.size(), kCheapGrain, [&](size_t from, size_t to) {
      for (size_t k = from; k < to; ++k)
        if (sides_[k] == Side::Unknown) sides_[k] = decided(numberAt(k), doubtAt(k) + changeInReach(k));
    });
    if (blocks_.side > 1 && (blocks_.reach > 0.0 || hasExactNumbers())) findRest();
  }

 private:
  /// Numbers that are closer than this to each other tell which whole number lies between.
  static constexpr double kWhole = 0.45;
  /// Numbers that are less exact are asked for again, unless they tell the sides.
  static constexpr double kMostDoubt = 1e-2;
  static constexpr size_t kPointsAtOnce = 256;

  /// Returns whether a point tells the sides of others or its own.
  bool isAsked(uint32_t k) const { return farthest_[k] == k && changes_[cubes_[k]].bend < kWhole; }

  /// Returns whether neither the side of such a point is known nor its number.
  bool isOpen(uint32_t k) const { return sides_[k] == Side::Unknown && !(numbers_[k].doubt < kMostDoubt); }

  void joinAll() {
    // Exceeds the errors of two distances.
    const double overlap = 2.0 * surface_.grid.spacing * double(slack_);
    farthest_.resize(blocks_.points.size());
    neighbours_.resize(blocks_.points.size());
    cubes_.resize(blocks_.points.size());
    changes_.resize(blocks_.begins.size() - 1);
    parallelFor(blocks_.begins.size() - 1, 64, [&](size_t from, size_t to) {
      JoinedPoints joined(blocks_.side);
      for (size_t cube = from; cube < to; ++cube) {
        const size_t begin = blocks_.begins[cube], end = blocks_.begins[cube + 1];
        joined.join(blocks_, begin, end, overlap, farthest_);
        for (size_t k = begin; k < end; ++k)
          if (farthest_[k] == k) neighbours_[k] = joined.farthestNeighbour(blocks_.places[k]);
        std::fill(cubes_.begin() + ptrdiff_t(begin), cubes_.begin() + ptrdiff_t(end), uint32_t(cube));
        changes_[cube] = changeIn(begin);
      }
    });
  }

  /// Finds numbers, and the sides that follow from them, from those of neighbours farther from the surface
  /// and the faces between.
  void cross() {
    parallelFor(changes_.size(), 8, [&](size_t from, size_t to) {
      std::vector<uint32_t> points, faces;
      for (size_t cube = from; cube < to; ++cube) {
        points.clear();
        for (auto k = uint32_t(blocks_.begins[cube]); k < blocks_.begins[cube + 1]; ++k)
          if (isAsked(k) && neighbours_[k] != k) points.push_back(k);
        std::ranges::stable_sort(points, std::greater(), [&](uint32_t k) { return blocks_.distances[k]; });
        for (const uint32_t k : points) take(k, numberBeside(k, faces));
      }
    });
  }

  /// Returns the number that follows from a neighbour's. `faces` is room to work in.
  Number numberBeside(uint32_t point, std::vector<uint32_t>& faces) const {
    const uint32_t neighbour = neighbours_[point];
    const double doubt = doubtAt(neighbour);
    if (!(doubt < kWhole)) return {0.0, INFINITY};
    const glm::dvec3 from = blocks_.points[neighbour], to = blocks_.points[point];
    const int32_t change = crossingsBetween(surface_, from, to, faces);
    if (change == kUnsure) return {0.0, INFINITY};
    return {numberAt(neighbour) + change + glm::dot(changes_[cubes_[point]].slope, to - from), doubt};
  }

  /// Finds the sides of all that some points are joined to, the quickest way first.
  void ask(std::span<const uint32_t> which) {
    parallelFor(which.size(), 64, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i) take(which[i], known(which[i]));
    });
    // A point alone is as well queried by the caller.
    if (blocks_.side == 1 && blocks_.reach == 0.0) return;
    const std::vector<uint32_t> open = openOf(which);
    parallelFor(open.size(), kPointsAtOnce,
                [&](size_t from, size_t to) { compute(std::span(open).subspan(from, to - from)); });
  }

  /// Does the same without what is known of other points.
  void compute(std::span<const uint32_t> which) {
    PointWinding winding(surface_.windingSource());
    std::vector<double> numbers(which.size());
    if (surface_.rims.count() <= kFewRims) {  // With more, few numbers are quick.
      winding.compute(PointArrays(*this, which).points(), numbers);
      for (size_t i = 0; i < which.size(); ++i) take(which[i], {numbers[i], winding.doubtOf(i)});
    }
    const std::vector<uint32_t> open = openOf(which);
    numbers.resize(open.size());
    winding.computeClosely(PointArrays(*this, open).points(), numbers, kNumberError);
    for (size_t i = 0; i < open.size(); ++i) take(open[i], {numbers[i], errorOf(numbers[i])});
  }

  /// Some points, as `PointWinding` takes them.
  struct PointArrays {
    PointArrays(const SideFinder& finder, std::span<const uint32_t> which) {
      const PreparedSurface& surface = finder.surface_;
      for (const uint32_t k : which) {
        const glm::dvec3 point = finder.blocks_.points[k], offset = point - surface.mesh.origin;
        cells.push_back(toCells(surface.grid, point));
        exact.push_back(offset * shrinkingOf(offset));
        distances.push_back(float(finder.blocks_.distances[k] / surface.grid.spacing));
      }
    }
    WindingPoints points() const { return {cells, exact, distances}; }

    std::vector<glm::vec3> cells;
    std::vector<glm::dvec3> exact;
    std::vector<float> distances;
  };

  /// Returns those points of which neither the side is known nor the number.
  std::vector<uint32_t> openOf(std::span<const uint32_t> which) const {
    std::vector<uint32_t> open;
    std::ranges::copy_if(which, std::back_inserter(open), [&](uint32_t k) { return isOpen(k); });
    return open;
  }

  /// Returns how far a number may be wrong that was computed closely.
  double errorOf(double number) const {
    const bool isNear = std::abs(std::abs(number) - surface_.threshold) < 2.0 * kNumberError;
    return isNear && hasExactNumbers() ? kExactNumberError : kNumberError;
  }

  /// Returns what follows from a number of the larger cube.
  Number known(uint32_t point) const {
    if (std::isnan(near_[point]) || !hasExactNumbers()) return {0.0, INFINITY};
    return numberNear(surface_, blocks_.points[point], near_[point]);
  }

  /// Returns the side of a number that may be wrong by some doubt.
  Side decided(double number, double doubt) const {
    if (!(std::abs(std::abs(number) - surface_.threshold) > doubt)) return Side::Unknown;
    return std::abs(number) > surface_.threshold ? Side::Inside : Side::Outside;
  }

  /// Keeps a point's number, and the side of all that it is joined to if that follows.
  void take(uint32_t point, const Number& number) {
    if (!(number.doubt < numbers_[point].doubt)) return;
    numbers_[point] = number;
    const auto& [slope, bend] = changes_[cubes_[point]];
    sides_[point] = decided(number.winding, 2.0 * radius() * glm::length(slope) + bend + number.doubt);
  }

  /// Returns the number of a point that follows from that of the point it is joined to.
  double numberAt(size_t point) const {
    const size_t asked = farthest_[point];
    const glm::dvec3 way = blocks_.points[point] - blocks_.points[asked];
    return numbers_[asked].winding + glm::dot(changes_[cubes_[point]].slope, way);
  }

  /// Returns how far that may be wrong.
  double doubtAt(size_t point) const {
    return numbers_[farthest_[point]].doubt + changes_[cubes_[point]].bend;
  }

  /// Returns by how much the slope changes a point's number within its reach.
  double changeInReach(size_t point) const {
    return blocks_.reach * glm::length(changes_[cubes_[point]].slope);
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
    SideFinder(surface_, blocks, rest.near, found).find();
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
      halved.near.push_back(doubtAt(k) < kWhole ? numberAt(k) : NAN);
      halved.places.push_back(uint16_t((p.z * side + p.y) * side + p.x));
    }
    return halved;
  }

  const PreparedSurface& surface_;
  const BlockPoints& blocks_;
  std::span<const double> near_;
  std::span<Side> sides_;
  float slack_;                       // Exceeds the errors of positions in the tree.
  std::vector<uint32_t> farthest_;    // Of each point, the farthest of its cube that it is joined to.
  std::vector<uint32_t> neighbours_;  // Of these, the farthest neighbour if that is farther, else themselves.
  std::vector<uint32_t> cubes_;
  std::vector<RimChange> changes_;  // In the ball about each cube, and what its points reach.
  std::vector<Number> numbers_;     // Of those farthest points.
};

}  // namespace

void findSides(const PreparedSurface& surface, const BlockPoints& blocks, std::span<Side> sides) {
  if (!surface.isSigned) {
    std::ranges::fill(sides, Side::Outside);
    return;
  }
  const std::vector<double> near(blocks.points.size(), NAN);
  SideFinder(surface, blocks, near, sides).find();
}

}  // namespace raymap::cpu
