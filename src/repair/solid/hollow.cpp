#include "repair/solid/hollow.h"

#include <raymap/isosurface.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "field/leaf_order.h"
#include "field/sample_places.h"
#include "mesh/pieces.h"
#include "repair/solid/solid_band.h"
#include "repair/stages.h"

namespace raymap {

namespace {

constexpr double kLevel = 0.8;      // Cosine of the steepest slope of a floor.
constexpr double kSpacious = 1e-3;  // Share of the space around a hole's place that counts as its depth.

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

/// Flood fill of one hollow at a time, through samples and tiles. Tiles are numbered after the values.
class Flood {
 public:
  Flood(const Field& solid, double wall, double least, const glm::dvec3& down)
      : solid_(solid),
        places_(solid),
        wall_(wall),
        least_(least),
        down_(glm::normalize(down)),
        isSeen_(solid.distance.size() + (solid.narrow ? solid.narrow->tiles.size() : 0)) {}

  bool isNew(size_t number) const {
    return !isSeen_[number] && (isTile(number) || solid_.distance[number] < -wall_);
  }

  Hollow follow(size_t first) {
    Hollow hollow;
    double low = -INFINITY, high = -INFINITY;
    numbers_.clear();
    visit(places_.at(first));
    for (size_t next = 0; next < numbers_.size();) {
      const size_t number = numbers_[next++];
      if (isTile(number)) {
        const NarrowBand::Tile& tile = solid_.narrow->tiles[number - solid_.distance.size()];
        hollow.deepest = INFINITY;
        visitBeside(tile.low, glm::min(glm::ivec3(tile.side), solid_.grid.dims - tile.low));
        continue;
      }
      const glm::ivec3 place = places_.at(number);
      const double room = -wall_ - double(solid_.distance[number]);
      hollow.deepest = std::max(hollow.deepest, room);
      // A ball of radius `room` around the sample is free.
      const glm::dvec3 step = room / solid_.grid.spacing * down_;
      const glm::dvec3 lowest = glm::dvec3(place) + step, highest = glm::dvec3(place) - step;
      const double space = kSpacious * std::min(room, least_) / solid_.grid.spacing;
      if (const double d = space + glm::dot(lowest, down_); d > low) low = d, hollow.lowest = lowest;
      if (const double d = space - glm::dot(highest, down_); d > high) high = d, hollow.highest = highest;
      if (room < solid_.grid.spacing && isLevel(place)) hollow.floors.push_back(lowest);
      visitBeside(place, glm::ivec3(1));
    }
    return hollow;
  }

  /// Makes the last hollow, which has no tiles, part of the wall.
  void fill(Field& solid) const {
    for (const size_t place : numbers_) solid.distance[place] = static_cast<float>(-0.5 * wall_);
  }

 private:
  bool isTile(size_t number) const { return number >= solid_.distance.size(); }

  /// Returns whether the nearest wall is below a sample.
  bool isLevel(const glm::ivec3& place) {
    glm::dvec3 outwards(0.0);
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1}) {
        glm::ivec3 next = place;
        next[axis] += step;
        if (const int64_t found = places_.find(next); found >= 0)
          outwards[axis] += step * double(solid_.distance[size_t(found)]);
      }
    return glm::dot(outwards, down_) > kLevel * glm::length(outwards);
  }

  /// Visits the samples beside a box of them.
  void visitBeside(const glm::ivec3& low, const glm::ivec3& size) {
    for (int axis = 0; axis < 3; ++axis)
      for (const int step : {-1, size[axis]})
        for (int v = 0; v < size[(axis + 2) % 3]; ++v)
          for (int u = 0; u < size[(axis + 1) % 3]; ++u) {
            glm::ivec3 next = low;
            next[axis] += step;
            next[(axis + 1) % 3] += u;
            next[(axis + 2) % 3] += v;
            visit(next);
          }
  }

  void visit(const glm::ivec3& sample) {
    int64_t found = places_.find(sample);
    if (found == LeafTree::kInside) {
      const auto& tiles = solid_.narrow->tiles;
      const auto after = std::ranges::upper_bound(tiles, sample, comesBefore, &NarrowBand::Tile::low);
      found = int64_t(solid_.distance.size()) + (after - tiles.begin()) - 1;
    }
    if (found < 0 || !isNew(size_t(found))) return;
    isSeen_[size_t(found)] = true;
    numbers_.push_back(size_t(found));
  }

  const Field& solid_;
  SamplePlaces places_;
  double wall_, least_;
  glm::dvec3 down_;
  std::vector<bool> isSeen_;
  std::vector<size_t> numbers_;  // Those of the last hollow, in the order of the fill.
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
  Flood flood(solid, wall, least, down);
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
  if (solid.narrow) solid.narrow->tiles.clear();
}

DrainHole placeHole(const Field& solid, const glm::dvec3& start, double radius, const glm::dvec3& direction) {
  const Grid& grid = solid.grid;
  const SolidSampler sampler(solid);
  const double reach = radius / grid.spacing;
  const glm::dvec3 step = glm::normalize(direction);
  // The hole ends where the solid is farther than its radius, so the whole of its end is free. It is at most
  // as long as the grid's diagonal.
  glm::dvec3 end = start;
  for (const double last = glm::length(glm::dvec3(grid.dims - 1)); glm::distance(end, start) <= last;) {
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
  const SolidSampler sampler(solid);
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
  SamplePlaces places(solid);
  for (int k = low.z; k <= high.z; ++k)
    for (int j = low.y; j <= high.y; ++j)
      for (int i = low.x; i <= high.x; ++i) {
        const int64_t found = places.find({i, j, k});
        if (found < 0) continue;
        float& d = solid.distance[size_t(found)];
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
