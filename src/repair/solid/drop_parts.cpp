#include <raymap/error.h>
#include <raymap/local_thickness.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "cpu/points/close_distances.h"
#include "repair/solid/deviation.h"
#include "repair/stages.h"
#include "repair/topology/drop_pieces.h"

namespace raymap {

namespace {

/// Returns how far, in samples, a surface may lie from the mesh that it shows: both are moved by the offset.
double reachOf(const RepairRun& run) {
  return 1.0 + std::abs(run.options.offset) / run.grid.spacing;
}

/// Finds the pieces of the surface that a choice drops, but that show surface of the mesh that no other piece
/// shows.
std::vector<bool> findNeeded(RepairRun& run, const Pieces& found, const Choice& choice) {
  const Grid& grid = run.grid;
  const double reach = reachOf(run);
  Mesh dropped = run.result, rest = run.result;
  dropFrom(dropped, found, opposite(choice));
  dropFrom(rest, found, choice);
  std::vector<uint32_t> pieces;  // Of the faces of `dropped`.
  for (const uint32_t p : found.ids)
    if (choice.isDropped[p]) pieces.push_back(p);
  const cpu::CloseDistances close(dropped, grid, reach * grid.spacing);
  std::vector<glm::vec3> points;
  std::vector<uint32_t> pointPieces;
  const SurfacePoints all = surfacePoints(run.mesh(), grid, kPointStep);
  forEachPart(all.positions, grid, [&](std::span<const glm::vec3> cells, std::span<const glm::dvec3> part) {
    const QueryResult near = close.measure(part);
    for (size_t i = 0; i < part.size(); ++i)
      if (near.triangle[i] != kNoTriangle) {
        points.push_back(cells[i]);
        pointPieces.push_back(pieces[near.triangle[i]]);
      }
  });
  std::vector<bool> needed(found.pieces.size());
  const std::vector<float> distances = distancesTo(rest, grid, points, run.progress);
  for (size_t i = 0; i < points.size(); ++i)
    if (distances[i] > reach) needed[pointPieces[i]] = true;
  return needed;
}

}  // namespace

void requireInside(const Field& solid) {
  const bool hasTiles = solid.narrow && !solid.narrow->tiles.empty();
  if (!hasTiles && std::ranges::none_of(solid.distance, [](float d) { return d < 0.0f; }))
    throw Error(ErrorCode::Input,
                "the result is empty: the mesh encloses no volume at this resolution, or the offset removes "
                "all of it; use more samples, or for a sheet a least thickness");
}

void requireParts(const Mesh& surface) {
  if (surface.triangles.empty())
    throw Error(ErrorCode::Input,
                "every part is smaller than the volume below which parts are dropped; use a smaller volume");
}

void dropPieces(RepairRun& run) {
  const RepairOptions& options = run.options;
  Mesh& surface = run.result;
  Pieces found = findPieces(Model(surface));
  nestPieces(surface, 1, found);
  Choice choice = choosePieces(found, options, options.keepCavities, run.report);
  if (!options.dropSmaller && run.report.dropped.count > 0)
    choice = choosePieces(found, options, options.keepCavities, run.report, findNeeded(run, found, choice));
  warnOfRemoved(found, choice, run.report, [&](const Warning& warning) {
    if (options.dropSmaller || warning.code != WarningCode::PartsDropped) run.machine.warn(warning);
  });
  if (choice.count == 0) return;
  dropFrom(run.solid, surface, found, choice);
  if (options.dropSmaller) {
    run.dropped = surface;
    dropFrom(run.dropped, found, opposite(choice));
  }
  dropFrom(surface, found, choice);
  requireParts(surface);
}

void leaveOutDropped(RepairRun& run) {
  std::vector<FacePoint>& lost = run.lost;
  if (lost.empty()) return;
  const auto area = [&] {
    return std::accumulate(lost.begin(), lost.end(), 0.0,
                           [](double sum, const FacePoint& p) { return sum + p.area; });
  };
  const double before = area();
  std::vector<glm::vec3> points;
  for (const FacePoint& p : lost) points.emplace_back((p.position - run.grid.origin) / run.grid.spacing);
  const std::vector<float> distances = distancesTo(run.dropped, run.grid, points, run.progress);
  Box& bounds = run.report.loss.droppedBounds;
  size_t k = 0;
  std::erase_if(lost, [&](const FacePoint& p) {
    if (distances[k++] > reachOf(run)) return false;
    bounds.min = glm::min(bounds.min, p.position), bounds.max = glm::max(bounds.max, p.position);
    return true;
  });
  if (before > 0.0) run.lostShare *= area() / before;
}

}  // namespace raymap
