#include "repair/measure.h"

#include <algorithm>
#include <cmath>

#include "repair/deviation.h"

namespace raymap {

namespace {

constexpr double kStep = 0.5;  // Of the points that are measured, in samples.

/// Leaves out what the drain holes made or took away.
void dropDrilled(std::vector<glm::vec3>& points, const Grid& grid, const std::vector<DrainHole>& holes) {
  std::erase_if(points, [&](const glm::vec3& p) {
    return std::ranges::any_of(
        holes, [&](const DrainHole& hole) { return hole.distance(grid.position(p)) < grid.spacing; });
  });
}

/// From the mesh's surface moved by the offset or of the hollow.
Deviation measureResult(const PackedMesh& result, const PackedMesh& mesh, const Grid& grid,
                        const RepairOptions& repair, const std::vector<DrainHole>& holes,
                        Progress& progress) {
  std::vector<glm::vec3> points = surfacePoints(result, grid, kStep);
  dropDrilled(points, grid, holes);
  std::vector<float> distances = distancesTo(mesh, grid, points, progress);
  const double outer = std::abs(repair.offset) / grid.spacing;
  const double inner = std::abs(repair.offset - repair.shell) / grid.spacing;
  for (float& d : distances)
    d = static_cast<float>(std::min(std::abs(double(d) - outer), std::abs(double(d) - inner)));
  return summarize(distances, grid.spacing);
}

enum class Side : uint8_t { Surface, Inside, Outside };

/// On which side of the mesh's solid all samples around a point lie, if they agree.
Side sideOf(const Field& solid, double offset, const glm::vec3& p) {
  const glm::ivec3 low = glm::clamp(glm::ivec3(glm::floor(p)), glm::ivec3(0), solid.grid.dims - 1);
  const glm::ivec3 high = glm::min(low + 1, solid.grid.dims - 1);
  int inside = 0;
  for (int c = 0; c < 8; ++c) {
    const glm::ivec3 s(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z);
    inside += double(solid.distance[solid.grid.index(s)]) + offset < 0.0 ? 1 : 0;
  }
  return inside == 8 ? Side::Inside : inside == 0 ? Side::Outside : Side::Surface;
}

Deviation measureMesh(std::vector<glm::vec3> points, const PackedMesh& result, const Grid& grid,
                      const RepairOptions& repair, const std::vector<DrainHole>& holes, Progress& progress) {
  dropDrilled(points, grid, holes);
  std::vector<float> distances = distancesTo(result, grid, points, progress);
  for (float& d : distances) d = std::abs(d - static_cast<float>(std::abs(repair.offset) / grid.spacing));
  return summarize(distances, grid.spacing);
}

void inspect(const PackedMesh& mesh, Diagnostics& found, SelfIntersections& crossing) {
  found = diagnose(mesh);
  crossing = findSelfIntersections(mesh);
}

}  // namespace

std::vector<glm::vec3> visiblePoints(const PackedMesh& mesh, const Field& solid, const RepairOptions& repair,
                                     RepairReport& report) {
  std::vector<glm::vec3> points = surfacePoints(mesh, solid.grid, kStep);
  const auto count = double(points.size());
  size_t buried = 0, lost = 0;
  std::erase_if(points, [&](const glm::vec3& p) {
    const Side side = sideOf(solid, repair.offset, p);
    buried += side == Side::Inside ? 1 : 0;
    lost += side == Side::Outside ? 1 : 0;
    return side != Side::Surface;
  });
  report.buriedShare = double(buried) / count;
  report.lostShare = double(lost) / count;
  return points;
}

void measure(const PackedMesh& mesh, const PackedMesh& result, const Grid& grid, const RepairOptions& repair,
             const std::vector<DrainHole>& holes, std::vector<glm::vec3> visible, Progress& progress,
             RepairReport& report) {
  inspect(mesh, report.before, report.crossingBefore);
  progress.report(0.1);
  inspect(result, report.after, report.crossingAfter);
  progress.part(0.2, 0.6);
  report.ofMesh = measureMesh(std::move(visible), result, grid, repair, holes, progress);
  progress.part(0.6, 1.0);
  report.ofResult = measureResult(result, mesh, grid, repair, holes, progress);
}

}  // namespace raymap
