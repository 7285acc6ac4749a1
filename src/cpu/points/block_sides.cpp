// Ours: signs of lattice points near each other, where Krayer & Müller 2019, §3.5, send rays from every
// sample.
//
// A ball about a point, as large as its distance, holds no surface. Where the balls of two points meet, the
// winding number changes between the points by what the rims say alone, and that has a bound. So one point
// tells the side of all that such balls join.

#include "cpu/points/block_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "base/parallel.h"
#include "cpu/points/point_query.h"
#include "cpu/points/segment_crossings.h"

namespace raymap::cpu {

namespace {

/// Larger than the error of any winding number of a query: up to 4,096 rims, and beyond.
constexpr double kExactNumberError = 1e-5, kDipoleNumberError = 1e-3;
constexpr size_t kExactRims = 4096;

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
    size_t p = 0;
    for (int z = 0; z < side_; ++z)
      for (int y = 0; y < side_; ++y)
        for (int x = 0; x < side_; ++x, ++p) {
          roots_[p] = uint16_t(p);
          if (x > 0) joinTo(p, p - 1, needed);
          if (y > 0) joinTo(p, p - size_t(side_), needed);
          if (z > 0) joinTo(p, p - size_t(side_) * size_t(side_), needed);
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

  void joinTo(size_t p, size_t q, double needed) {
    if (distances_[p] + distances_[q] <= needed) return;
    const uint16_t a = rootOf(p), b = rootOf(q);
    roots_[std::max(a, b)] = std::min(a, b);
  }

  int side_;
  size_t count_;
  std::array<double, kMostPlaces> distances_;
  std::array<uint16_t, kMostPlaces> roots_;
  std::array<uint32_t, kMostPlaces> chosen_;
};

/// Returns whether winding numbers are whole, so that they change at the surface alone.
bool isWhole(const PreparedSurface& surface) {
  return !surface.isSigned || surface.lattice.isWhole();
}

/// A winding number and how far it may be wrong.
struct Number {
  double winding, doubt;
};

/// Returns the side of all points of a ball that are joined to this one, which has this winding number.
Side sideOf(const PreparedSurface& surface, const glm::dvec3& point, const Number& number,
            const glm::dvec3& centre, double radius) {
  const Side side = std::abs(number.winding) > surface.threshold ? Side::Inside : Side::Outside;
  if (isWhole(surface)) return side;
  const double gap = std::abs(std::abs(number.winding) - surface.threshold) - number.doubt;
  if (gap <= 0.0) return Side::Unknown;
  const double way = glm::distance(point, centre) + radius;
  const double change = way * surface.rims.mostGradient(centre - surface.mesh.origin, radius);
  return change < gap ? side : Side::Unknown;
}

/// Returns the place of a point in its cube, along each axis.
glm::ivec3 placeOf(const BlockPoints& blocks, size_t point) {
  const int side = blocks.side, place = blocks.places[point];
  return {place % side, place / side % side, place / side / side};
}

/// Returns the middle of a point's cube.
glm::dvec3 middleOf(const BlockPoints& blocks, size_t point) {
  const glm::dvec3 toMiddle = 0.5 * double(blocks.side - 1) - glm::dvec3(placeOf(blocks, point));
  return blocks.points[point] + blocks.spacing * toMiddle;
}

/// Returns some of the points.
std::vector<glm::dvec3> pointsOf(const BlockPoints& blocks, std::span<const uint32_t> which) {
  std::vector<glm::dvec3> points;
  for (const uint32_t k : which) points.push_back(blocks.points[k]);
  return points;
}

/// Finds the sides of all that some points are joined to: from quick numbers, and where these are in doubt,
/// from exact ones.
void askFirsts(const PreparedSurface& surface, const BlockPoints& blocks, std::span<const uint32_t> firsts,
               Progress& progress, std::span<Side> sides) {
  const double radius = 0.5 * std::sqrt(3.0) * double(blocks.side - 1) * blocks.spacing + blocks.reach;
  const auto decide = [&](std::span<const uint32_t> which, auto&& numberOf) {
    parallelFor(which.size(), 64, [&](size_t from, size_t to) {
      for (size_t i = from; i < to; ++i)
        sides[which[i]] =
            sideOf(surface, blocks.points[which[i]], numberOf(i), middleOf(blocks, which[i]), radius);
    });
  };
  DoubtfulNumbers numbers;
  queryNumbers(surface, PointsView(pointsOf(blocks, firsts)), progress, numbers);
  decide(firsts, [&](size_t i) { return Number{numbers.winding[i], numbers.doubt[i]}; });
  if (isWhole(surface)) return;
  std::vector<uint32_t> rest;
  std::ranges::copy_if(firsts, std::back_inserter(rest),
                       [&](uint32_t k) { return sides[k] == Side::Unknown; });
  QueryResult found;
  queryPoints(surface, PointsView(pointsOf(blocks, rest)), {.distance = false, .winding = true}, progress,
              found);
  const double error = surface.rims.count() <= kExactRims ? kExactNumberError : kDipoleNumberError;
  decide(rest, [&](size_t i) { return Number{double(found.winding[i]), error}; });
}

/// Some points, in smaller cubes.
struct HalvedPoints {
  std::vector<uint32_t> numbers;  ///< Of each point among those of the whole cubes.
  std::vector<glm::dvec3> points;
  std::vector<double> distances;
  std::vector<uint16_t> places;
  std::vector<size_t> begins;

  /// Takes those points whose side is not known.
  HalvedPoints(const BlockPoints& blocks, std::span<const Side> sides) {
    std::array<std::vector<uint32_t>, 8> halves;
    for (size_t cube = 0; cube + 1 < blocks.begins.size(); ++cube) {
      for (size_t k = blocks.begins[cube]; k < blocks.begins[cube + 1]; ++k)
        if (sides[k] == Side::Unknown) {
          const glm::ivec3 half = placeOf(blocks, k) / (blocks.side / 2);
          halves[size_t(half.x + 2 * half.y + 4 * half.z)].push_back(uint32_t(k));
        }
      for (std::vector<uint32_t>& half : halves) {
        if (!half.empty()) begins.push_back(numbers.size());
        numbers.insert(numbers.end(), half.begin(), half.end());
        half.clear();
      }
    }
    begins.push_back(numbers.size());
    const int side = blocks.side / 2;
    for (const uint32_t k : numbers) {
      const glm::ivec3 p = placeOf(blocks, k) % side;
      points.push_back(blocks.points[k]);
      distances.push_back(blocks.distances[k]);
      places.push_back(uint16_t((p.z * side + p.y) * side + p.x));
    }
  }
};

/// Asks again for what is not known, in smaller cubes.
void findRest(const PreparedSurface& surface, const BlockPoints& blocks, Progress& progress,
              std::span<Side> sides) {
  const HalvedPoints rest(blocks, sides);
  if (rest.numbers.empty()) return;
  std::vector<Side> found(rest.numbers.size());
  findSides(
      surface,
      {blocks.side / 2, blocks.spacing, blocks.reach, rest.points, rest.distances, rest.places, rest.begins},
      progress, found);
  for (size_t k = 0; k < found.size(); ++k) sides[rest.numbers[k]] = found[k];
}

}  // namespace

void findSides(const PreparedSurface& surface, const BlockPoints& blocks, Progress& progress,
               std::span<Side> sides) {
  if (!surface.isSigned) {
    std::ranges::fill(sides, Side::Outside);
    return;
  }
  // Exceeds the errors of two distances.
  const double overlap = 2.0 * surface.grid.spacing * double(slackOf(surface.tree, surface.grid.dims));
  std::vector<uint32_t> firsts(blocks.points.size());
  const size_t cubes = blocks.begins.size() - 1;
  parallelFor(cubes, 64, [&](size_t from, size_t to) {
    JoinedPoints joined(blocks.side);
    for (size_t cube = from; cube < to; ++cube)
      joined.join(blocks, blocks.begins[cube], blocks.begins[cube + 1], overlap, firsts);
  });
  const std::vector<uint32_t> asked =
      parallelSelect(firsts.size(), [&](uint32_t k) { return firsts[k] == k; });
  askFirsts(surface, blocks, asked, progress, sides);
  parallelFor(firsts.size(), kCheapGrain, [&](size_t from, size_t to) {
    for (size_t k = from; k < to; ++k)
      if (firsts[k] != k) sides[k] = sides[firsts[k]];
  });
  // A point alone is as well queried by the caller.
  if (blocks.side > (blocks.reach > 0.0 ? 1 : 2)) findRest(surface, blocks, progress, sides);
}

}  // namespace raymap::cpu
