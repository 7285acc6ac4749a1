#include "cpu/points/lattice_query.h"

#include "base/morton.h"
#include "base/parallel.h"
#include "cpu/points/block_distances.h"
#include "cpu/points/point_query.h"

namespace raymap::cpu {

namespace {

constexpr int kSignSide = BlockPoints::kMostSide;  ///< Side of the cubes whose samples share signs.
constexpr size_t kCubesPerTask = 64;

}  // namespace

void LatticeQuery::ask(std::span<const AskedCube> cubes) {
  cubes_.assign(cubes.begin(), cubes.end());
  list();
  if (options_.winding || options_.confidence) {
    queryPoints(surface_, PointsView(std::span(points_)), options_, quiet_, found_);
    return;
  }
  measure();
  sign();
}

size_t LatticeQuery::countOf(const AskedCube& cube) const {
  size_t count = 0;
  for (int part = 0; part < 8; ++part) {
    if (!(cube.parts >> part & 1)) continue;
    const glm::ivec3 low = cube.low + kPartSide * cornerOf(part);
    const glm::ivec3 size = glm::max(glm::min(low + kPartSide, high_) - glm::max(low, low_), 0);
    count += size_t(size.x) * size_t(size.y) * size_t(size.z);
  }
  return count;
}

/// Lists the points that are asked for.
void LatticeQuery::list() {
  begins_.assign(1, 0);
  for (const AskedCube& cube : cubes_) begins_.push_back(begins_.back() + countOf(cube));
  points_.resizeUninitialized(begins_.back());
  places_.resizeUninitialized(begins_.back());
  codes_.resizeUninitialized(begins_.back());
  parallelFor(cubes_.size(), kCubesPerTask, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const std::array<std::array<OnAxis, kSide>, 3> axes = axesOf(cubes_[k].low);
      visit(k, [&](const glm::ivec3& sample, size_t point) {
        const glm::ivec3 s = sample - cubes_[k].low;
        const OnAxis &x = axes[0][size_t(s.x)], &y = axes[1][size_t(s.y)], &z = axes[2][size_t(s.z)];
        points_[point] = {x.position, y.position, z.position};
        places_[point] = uint16_t(x.place + y.place + z.place);
        codes_[point] = uint16_t(x.code + y.code + z.code);
      });
    }
  });
}

/// Returns the shares of all coordinates of a cube's samples, by axis.
std::array<std::array<LatticeQuery::OnAxis, LatticeQuery::kSide>, 3> LatticeQuery::axesOf(
    const glm::ivec3& low) const {
  std::array<std::array<OnAxis, kSide>, 3> axes;
  for (int i = 0; i < kSide; ++i) {
    const glm::dvec3 position = lattice_.position(glm::dvec3(low + i));
    for (int axis = 0, step = 1; axis < 3; ++axis, step *= kSignSide) {
      glm::uvec3 code(0);
      code[axis] = uint32_t(low[axis] + i) % kDistanceSide;
      axes[size_t(axis)][size_t(i)] = {position[axis], step * ((low[axis] + i) % kSignSide),
                                       int(mortonCode(code.x, code.y, code.z))};
    }
  }
  return axes;
}

/// Returns the cubes with this side that hold those of the query.
LatticeQuery::Groups LatticeQuery::groupsOf(int side) const {
  Groups groups;
  for (size_t k = 0; k < cubes_.size(); ++k) {
    const glm::ivec3 low = cubes_[k].low / side * side;
    if (!groups.lows.empty() && groups.lows.back() == low) continue;
    groups.lows.push_back(low);
    groups.begins.push_back(begins_[k]);
  }
  groups.begins.push_back(begins_.back());
  return groups;
}

/// Finds unsigned distances and triangles.
void LatticeQuery::measure() {
  found_.distance.resizeUninitialized(points_.size());
  found_.triangle.resizeUninitialized(points_.size());
  const Groups groups = groupsOf(kDistanceSide);
  parallelWorkers(groups.lows.size(), [&](const auto& next) {
    BlockDistances distances(surface_);
    for (size_t g = next(); g < groups.lows.size(); g = next()) {
      const size_t begin = groups.begins[g], count = groups.begins[g + 1] - begin;
      const LatticeBlock block{lattice_.position(glm::dvec3(groups.lows[g])), kDistanceSide,
                               lattice_.spacing};
      distances.find(block, std::span(points_).subspan(begin, count), std::span(codes_).subspan(begin, count),
                     options_.maxDistance, std::span(found_.distance).subspan(begin, count),
                     std::span(found_.triangle).subspan(begin, count));
    }
  });
}

/// Makes the distances inside negative.
void LatticeQuery::sign() {
  sides_.resizeUninitialized(points_.size());
  const Groups groups = groupsOf(kSignSide);
  findSides(surface_, {kSignSide, lattice_.spacing, 0.0, points_, found_.distance, places_, groups.begins},
            sides_);
  parallelFor(sides_.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (sides_[i] == Side::Inside) found_.distance[i] = -found_.distance[i];
  });
  const std::vector<uint32_t> rest =
      parallelSelect(sides_.size(), [&](uint32_t i) { return sides_[i] == Side::Unknown; });
  std::vector<glm::dvec3> points;
  for (const uint32_t i : rest) points.push_back(points_[i]);
  QueryResult found;
  queryPoints(surface_, PointsView(points), {.maxDistance = options_.maxDistance}, quiet_, found);
  for (size_t k = 0; k < rest.size(); ++k) found_.distance[rest[k]] = found.distance[k];
}

}  // namespace raymap::cpu
