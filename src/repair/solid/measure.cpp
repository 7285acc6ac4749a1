#include <raymap/local_thickness.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "mesh/triangle.h"
#include "repair/solid/deviation.h"
#include "repair/solid/solid_band.h"
#include "repair/stages.h"

namespace raymap {

namespace {

// Farther from the result than this, in samples, a point of the mesh is no surface of it. What a tolerance
// above the default allows comes on top.
constexpr double kFar = 1.0;
// Largest value of the field at a point of the moved surface, in samples: what interpolation gets wrong.
constexpr double kFieldError = 0.5;

// Most lost points to look at closely.
constexpr size_t kMostLost = 4096;

bool isDrilled(const glm::vec3& p, const Grid& grid, const std::vector<DrainHole>& holes) {
  return std::ranges::any_of(
      holes, [&](const DrainHole& hole) { return hole.distance(grid.position(p)) < grid.spacing; });
}

/// From the mesh's surface moved by the offset or of the hollow.
Deviation measureResult(RepairRun& run) {
  const Grid& grid = run.grid;
  const RepairOptions& options = run.options;
  SurfacePoints points = surfacePoints(run.result, grid, kPointStep);
  const std::vector<double> areas = areasOfPoints(run.result, points);
  points.eraseIf([&](size_t i) { return isDrilled(points.positions[i], grid, run.holes); });
  const std::vector<float> distances = distancesTo(run.mesh(), grid, points.positions, run.progress);
  const double outer = std::abs(options.offset) / grid.spacing;
  const double inner = std::abs(options.offset - options.shell) / grid.spacing;
  std::vector<AreaDistance> found;
  for (size_t i = 0; i < distances.size(); ++i) {
    const double d = distances[i];
    found.push_back(
        {static_cast<float>(std::min(std::abs(d - outer), std::abs(d - inner))), areas[points.faces[i]]});
  }
  return summarize(found, grid.spacing);
}

glm::dvec3 normalOf(const PackedMesh& mesh, uint32_t face) {
  const auto [a, b, c] = mesh.corners(mesh.triangles[face]);
  return unitNormal(a, b, c);
}

/// Moves a point of a face along the normal. Returns whether it is on the moved surface then. A face may
/// point either way. Other parts of the surface may be closer to the moved point than the offset; then they
/// took its place.
bool moveToPlace(const SolidSampler& solid, const glm::dvec3& move, glm::vec3& p) {
  const glm::dvec3 front = glm::dvec3(p) + move, back = glm::dvec3(p) - move;
  const double atFront = std::abs(solid.value(front)), atBack = std::abs(solid.value(back));
  p = atFront < atBack ? front : back;
  return std::min(atFront, atBack) <= kFieldError;
}

double areaOf(const std::vector<double>& areas, const SurfacePoints& points) {
  double sum = 0.0;
  for (const uint32_t face : points.faces) sum += areas[face];
  return sum;
}

/// Returns some points of the mesh, moved back onto their faces.
std::vector<FacePoint> onFaces(const ExpectedPoints& expected, std::span<const size_t> numbers,
                               const PackedMesh& mesh, const Grid& grid) {
  const SurfacePoints& points = expected.points;
  const size_t step = numbers.size() / kMostLost + 1;
  std::vector<FacePoint> result;
  for (size_t k = 0; k < numbers.size(); k += step) {
    const uint32_t face = points.faces[numbers[k]];
    const glm::dvec3 p = grid.position(points.positions[numbers[k]]), normal = normalOf(mesh, face);
    result.push_back({p - glm::dot(p - mesh.position(mesh.triangles[face].x), normal) * normal, face,
                      expected.areas[face]});
  }
  return result;
}

double farOf(const SimplifyReport& simplified, const Grid& grid) {
  return kFar + std::max(simplified.tolerance / grid.spacing - kDefaultTolerance, 0.0);
}

/// Tells the buried points from the lost ones, and measures all but the buried ones. Returns the lost ones.
std::vector<size_t> measureMesh(RepairRun& run) {
  const ExpectedPoints& expected = run.expected;
  const Grid& grid = run.grid;
  RepairReport& report = run.report;
  const std::vector<float> deviations =
      distancesTo(run.result, grid, expected.points.positions, run.progress);
  const double far = farOf(report.simplified, grid);
  std::vector<AreaDistance> visible, kept;
  std::vector<size_t> lost;
  double buriedArea = 0.0, lostArea = 0.0;
  for (size_t i = 0; i < deviations.size(); ++i) {
    const bool isFar = deviations[i] > far;
    const double area = expected.areas[expected.points.faces[i]];
    if (isFar && expected.isInside[i]) {
      buriedArea += area;
      continue;
    }
    visible.push_back({deviations[i], area});
    if (isFar) {
      lost.push_back(i);
      lostArea += area;
    } else {
      kept.push_back({deviations[i], area});
    }
  }
  if (const double area = areaOf(expected.areas, expected.points); area > 0.0) {
    report.buriedShare += run.fieldShare() * buriedArea / area;
    report.lostShare = run.fieldShare() * lostArea / area;
  }
  report.meshFromResult = summarize(visible, grid.spacing);
  report.keptFromResult = summarize(kept, grid.spacing);
  return lost;
}

/// Leaves out what the drain holes took away.
void eraseDrilled(ExpectedPoints& expected, const Grid& grid, const std::vector<DrainHole>& holes) {
  if (holes.empty()) return;
  size_t kept = 0;
  expected.points.eraseIf([&](size_t i) {
    const bool isErased = isDrilled(expected.points.positions[i], grid, holes);
    if (!isErased) expected.isInside[kept++] = expected.isInside[i];
    return isErased;
  });
  expected.isInside.resize(kept);
}

}  // namespace

void placeExpectedPoints(RepairRun& run) {
  const PackedMesh mesh = run.mesh();
  ExpectedPoints& expected = run.expected;
  SurfacePoints& points = expected.points = surfacePoints(mesh, run.grid, kPointStep);
  expected.areas = areasOfPoints(mesh, points);
  const double area = areaOf(expected.areas, points);
  const SolidSampler sampler(run.solid);
  const double offset = run.options.offset / run.grid.spacing;
  if (offset != 0.0)
    points.eraseIf([&](size_t i) {
      return !moveToPlace(sampler, offset * normalOf(mesh, points.faces[i]), points.positions[i]);
    });
  if (offset != 0.0 && area > 0.0) run.report.trimmedShare = 1.0 - areaOf(expected.areas, points) / area;
  expected.isInside.reserve(points.positions.size());
  for (const glm::vec3& p : points.positions) expected.isInside.push_back(sampler.value(p) < 0.0);
}

void measure(RepairRun& run) {
  run.progress.part(0.0, 0.6);
  eraseDrilled(run.expected, run.grid, run.holes);
  const std::vector<size_t> lost = measureMesh(run);
  run.progress.part(0.6, 1.0);
  run.report.resultFromMesh = measureResult(run);
  run.lost = onFaces(run.expected, lost, run.mesh(), run.grid);
  run.lostShare = run.report.lostShare;
  run.expected = {};
}

}  // namespace raymap
