#include "cpu/points/far_cubes.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cpu/points/point_query.h"
#include "cpu/points/segment_crossings.h"

namespace raymap::cpu {

namespace {

constexpr size_t kCubesAtATime = size_t{1} << 15;

/// Returns the distance from the centre of a cube to its outermost samples.
double radiusOf(int side, double spacing) {
  return 0.5 * std::sqrt(3.0) * double(side - 1) * spacing;
}

}  // namespace

void FarCubes::find(std::span<const glm::ivec3> cubes, int side, Progress& progress, std::span<Side> sides) {
  const auto parentOf = [&](size_t c) { return cubes[c] / (2 * side); };
  for (size_t begin = 0, end = 0; begin < cubes.size(); begin = end) {
    end = std::min(begin + kCubesAtATime, cubes.size());
    while (end < cubes.size() && parentOf(end) == parentOf(end - 1)) ++end;
    findSome(cubes.subspan(begin, end - begin), side, progress, sides.subspan(begin, end - begin));
  }
}

void FarCubes::findSome(std::span<const glm::ivec3> cubes, int side, Progress& progress,
                        std::span<Side> sides) {
  // A cube must be farther than the band by the errors of coordinates and distances.
  constexpr double kMargin = 1e-5;
  const double slack = 2.0 * surface_.grid.spacing * double(slackOf(surface_.tree, surface_.grid.dims)),
               radius = radiusOf(side, lattice_.spacing);
  const auto limit = [&](double width) { return (radius + width) * (1.0 + kMargin) + slack; };
  const double narrow = std::min(band_.outside, band_.inside), wide = std::max(band_.outside, band_.inside);
  centres_.resizeUninitialized(cubes.size());
  for (size_t c = 0; c < cubes.size(); ++c)
    centres_[c] = lattice_.position(glm::dvec3(cubes[c]) + 0.5 * double(side - 1));
  const QueryOptions query{.maxDistance = limit(std::isfinite(wide) ? wide : narrow)};
  queryUnsigned(surface_, PointsView(std::span(centres_)), query, progress, found_);
  const std::vector<uint32_t> far =
      parallelSelect(cubes.size(), [&](uint32_t c) { return found_.distance[c] >= limit(narrow); });
  const std::vector<Side> known = sidesOf(cubes, side, far);
  std::ranges::fill(sides, Side::Unknown);
  for (size_t k = 0; k < far.size(); ++k) {
    const double width = known[k] == Side::Inside ? band_.inside : band_.outside;
    if (found_.distance[far[k]] >= limit(width)) sides[far[k]] = known[k];
  }
}

/// Returns the sides of balls without surface about the centres of some cubes.
std::vector<Side> FarCubes::sidesOf(std::span<const glm::ivec3> cubes, int side,
                                    std::span<const uint32_t> far) {
  std::vector<glm::dvec3> centres;
  std::vector<double> distances;
  std::vector<uint16_t> places;
  std::vector<size_t> begins;
  for (size_t k = 0; k < far.size(); ++k) {
    const glm::ivec3 cube = cubes[far[k]] / side;
    if (k == 0 || cube / 2 != cubes[far[k - 1]] / side / 2) begins.push_back(k);
    centres.push_back(centres_[far[k]]);
    distances.push_back(found_.distance[far[k]]);
    places.push_back(uint16_t((cube.x & 1) | (cube.y & 1) << 1 | (cube.z & 1) << 2));
  }
  begins.push_back(far.size());
  std::vector<Side> sides(far.size());
  const double radius = radiusOf(side, lattice_.spacing);
  findSides(surface_, {2, double(side) * lattice_.spacing, radius, centres, distances, places, begins},
            sides);
  return sides;
}

}  // namespace raymap::cpu
