#include "repair/solid/hollow.h"

#include <raymap/isosurface.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "field/field_sampler.h"
#include "mesh/pieces.h"
#include "repair/stages.h"

namespace raymap {

namespace {

constexpr double kLevel = 0.8;  // Cosine of the steepest slope of a floor.

/// Returns the number of solids that lie in cavities.
size_t countLoose(const Mesh& mesh) {
  Pieces found = findPieces(Model(mesh));
  nestPieces(mesh, 1, found);
  return size_t(std::ranges::count_if(
      found.pieces, [](const Piece& piece) { return !piece.isCavity() && piece.around != Piece::kNone; }));
}

/// Warns of bodies that lie loose in the hollows of a result, and did not before it was hollowed out.
void warnOfLooseBodies(const Mesh& before, const Mesh& result, const WarningCallback& warn) {
  const size_t loose = countLoose(result), known = countLoose(before);
  if (loose <= known) return;
  const size_t count = loose - known;
  warn(
      {WarningCode::LooseBodies,
       std::to_string(count) + (count == 1 ? " body lies" : " bodies lie") +
           " loose in the hollow: the walls around sealed cavities that were kept; fill the cavities instead",
       {.count = count}});
}

/// Warns of hollows and drain holes that were asked for but not made.
void warnOfHoles(const RepairReport& report, const RepairOptions& repair, const WarningCallback& warn) {
  if (const size_t filled = report.filledHollows; filled > 0)
    warn({WarningCode::HollowsFilled,
          std::to_string(filled) + (filled == 1 ? " hollow is" : " hollows are") +
              " too small for the drain hole and stayed solid; use a smaller drain hole",
          {.count = filled}});
  else if (report.hollows == 0)
    warn({WarningCode::NoHollow,
          "the solid is nowhere thick enough for a hollow inside its walls, so it has none; use thinner "
          "walls"});
  if (repair.drainHole == 0.0) return;
  if (const size_t asked = report.hollows * size_t(repair.drainHoles); report.drainHoles < asked)
    warn({WarningCode::DrainHolesMissing,
          "only " + std::to_string(report.drainHoles) + " of " + std::to_string(asked) +
              " drain holes were made, because the level floors of the hollows have no place for more",
          {.count = asked - report.drainHoles}});
}

glm::ivec3 placeOf(const Grid& grid, size_t sample) {
  const size_t x = size_t(grid.dims.x), y = size_t(grid.dims.y);
  return {sample % x, sample / x % y, sample / (x * y)};
}

/// Flood fill of one hollow at a time.
class Flood {
 public:
  Flood(const Field& solid, double wall, const glm::dvec3& down)
      : solid_(solid),
        sampler_(solid),
        wall_(wall),
        down_(glm::normalize(down)),
        isSeen_(solid.distance.size()) {}

  bool isNew(size_t sample) const { return !isSeen_[sample] && solid_.distance[sample] < -wall_; }

  Hollow follow(size_t first) {
    Hollow hollow;
    double low = -INFINITY, high = -INFINITY;
    samples_.clear();
    push(first);
    size_t next = 0;
    while (next < samples_.size()) {
      const size_t sample = samples_[next++];
      const glm::ivec3 place = placeOf(solid_.grid, sample);
      const double room = -wall_ - double(solid_.distance[sample]);
      hollow.deepest = std::max(hollow.deepest, room);
      // A ball of radius `room` around the sample is free.
      const glm::dvec3 step = room / solid_.grid.spacing * down_;
      const glm::dvec3 lowest = glm::dvec3(place) + step, highest = glm::dvec3(place) - step;
      if (const double d = glm::dot(lowest, down_); d > low) low = d, hollow.lowest = lowest;
      if (const double d = -glm::dot(highest, down_); d > high) high = d, hollow.highest = highest;
      if (room < solid_.grid.spacing && isLevel(place)) hollow.floors.push_back(lowest);
      visitNeighbours(place);
    }
    return hollow;
  }

  /// Makes the last hollow part of the wall.
  void fill(Field& solid) const {
    for (const uint32_t sample : samples_) solid.distance[sample] = static_cast<float>(-0.5 * wall_);
  }

 private:
  void push(size_t sample) {
    isSeen_[sample] = true;
    samples_.push_back(static_cast<uint32_t>(sample));
  }

  /// Returns whether the nearest wall is below a sample.
  bool isLevel(const glm::ivec3& place) const {
    const glm::dvec3 outwards = sampler_.gradient(glm::dvec3(place));
    return glm::dot(outwards, down_) > kLevel * glm::length(outwards);
  }

  void visitNeighbours(const glm::ivec3& place) {
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        glm::ivec3 next = place;
        next[axis] += step;
        if (next[axis] < 0 || next[axis] >= solid_.grid.dims[axis]) continue;
        if (const size_t sample = solid_.grid.index(next); isNew(sample)) push(sample);
      }
  }

  const Field& solid_;
  FieldSampler sampler_;
  double wall_;
  glm::dvec3 down_;
  std::vector<bool> isSeen_;
  std::vector<uint32_t> samples_;  // Samples of the last hollow, in the order of the fill.
};

}  // namespace

double DrainHole::distance(const glm::dvec3& p) const {
  const double length = glm::distance(start, end);
  const glm::dvec3 axis = (end - start) / length;
  const double along = glm::dot(p - start, axis);
  return std::max({glm::length(p - start - along * axis) - radius, -along, along - length});
}

std::vector<Hollow> findHollows(Field& solid, double wall, double least, const glm::dvec3& down,
                                size_t& filled) {
  std::vector<Hollow> hollows;
  Flood flood(solid, wall, down);
  for (size_t sample = 0; sample < solid.distance.size(); ++sample) {
    if (!flood.isNew(sample)) continue;
    Hollow hollow = flood.follow(sample);
    if (hollow.deepest < least) {
      flood.fill(solid);
      ++filled;
    } else {
      hollows.push_back(std::move(hollow));
    }
  }
  return hollows;
}

void hollowOut(Field& solid, double wall) {
  parallelFor(solid.distance.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      float& d = solid.distance[i];
      d = std::max(d, static_cast<float>(-(double(d) + wall)));
    }
  });
}

DrainHole placeHole(const Field& solid, const glm::dvec3& start, double radius, const glm::dvec3& direction) {
  const Grid& grid = solid.grid;
  const FieldSampler sampler(solid);
  const double reach = radius / grid.spacing;
  const glm::dvec3 step = glm::normalize(direction);
  // The hole ends where the solid is farther than its radius, so the whole of its end is free. It is at most
  // as long as the grid's diagonal.
  glm::dvec3 end = start;
  for (const double last = glm::length(sampler.last()); glm::distance(end, start) <= last;) {
    end += 0.5 * step;
    if (sampler.value(end) > reach) break;
  }
  return {grid.position(start - reach * step), grid.position(end), radius};
}

std::vector<DrainHole> placeHoles(const Field& solid, const Hollow& hollow, int count, double radius,
                                  const glm::dvec3& down) {
  std::vector<DrainHole> holes{placeHole(solid, hollow.lowest, radius, down)};
  if (count > 1) holes.push_back(placeHole(solid, hollow.highest, radius, -down));
  std::vector<glm::dvec3> starts{hollow.lowest, hollow.highest};
  const auto apart = [&](const glm::dvec3& p) {
    double least = INFINITY;
    for (const glm::dvec3& start : starts) least = std::min(least, glm::distance(p, start));
    return least;
  };
  while (holes.size() < size_t(count) && !hollow.floors.empty()) {
    const glm::dvec3 farthest = *std::ranges::max_element(hollow.floors, {}, apart);
    if (apart(farthest) * solid.grid.spacing < 4.0 * radius) break;
    holes.push_back(placeHole(solid, farthest, radius, down));
    starts.push_back(farthest);
  }
  return holes;
}

DrainHolePlace exitOf(const Field& solid, const DrainHole& hole) {
  constexpr double kStep = 0.125;  // In samples.
  const FieldSampler sampler(solid);
  // glm::normalize multiplies by a rounded inverse, and gives -0.9999999999999999 along an axis.
  const glm::dvec3 way = hole.end - hole.start, direction = way / glm::length(way);
  const auto place = [&](const glm::dvec3& p) { return (p - solid.grid.origin) / solid.grid.spacing; };
  // Back from the end, which is free, to the solid.
  glm::dvec3 p = place(hole.end);
  const double length = glm::distance(p, place(hole.start));
  double back = 0.0;
  while (back < length && sampler.value(p) > 0.0) {
    p -= kStep * direction;
    back += kStep;
  }
  return {solid.grid.position(p), direction};
}

void drill(Field& solid, const DrainHole& hole) {
  constexpr double kMargin = 3.0;  // Samples around the hole that the isosurface may read.
  const Grid& grid = solid.grid;
  const auto place = [&](const glm::dvec3& p) { return (p - grid.origin) / grid.spacing; };
  const glm::dvec3 reach(hole.radius / grid.spacing + kMargin);
  const glm::ivec3 low =
      glm::max(glm::ivec3(glm::floor(glm::min(place(hole.start), place(hole.end)) - reach)), 0);
  const glm::ivec3 high =
      glm::min(glm::ivec3(glm::ceil(glm::max(place(hole.start), place(hole.end)) + reach)), grid.dims - 1);
  for (int k = low.z; k <= high.z; ++k)
    for (int j = low.y; j <= high.y; ++j)
      for (int i = low.x; i <= high.x; ++i) {
        float& d = solid.distance[grid.index({i, j, k})];
        d = std::max(d, static_cast<float>(-hole.distance(grid.position({i, j, k}))));
      }
}

void makeHollow(RepairRun& run) {
  const RepairOptions& options = run.options;
  RepairReport& report = run.report;
  const double radius = 0.5 * options.drainHole;
  for (const Hollow& found :
       findHollows(run.solid, options.shell, radius, options.down, report.filledHollows)) {
    ++report.hollows;
    if (radius == 0.0) continue;
    for (const DrainHole& hole : placeHoles(run.solid, found, options.drainHoles, radius, options.down)) {
      run.holes.push_back(hole);
      report.drainHolePlaces.push_back(exitOf(run.solid, hole));
    }
  }
  hollowOut(run.solid, options.shell);
  for (const DrainHole& hole : run.holes) drill(run.solid, hole);
  report.drainHoles = run.holes.size();
  warnOfHoles(report, options, run.machine.warn);
  Mesh hollowed = isosurface(run.solid, {}, run.machine);
  if (options.keepCavities) warnOfLooseBodies(run.result, hollowed, run.machine.warn);
  run.result = std::move(hollowed);
}

}  // namespace raymap
