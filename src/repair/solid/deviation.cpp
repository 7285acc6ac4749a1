#include "repair/solid/deviation.h"

#include <algorithm>
#include <cmath>

#include "cpu/points/close_distances.h"
#include "mesh/face_measures.h"
#include "mesh/face_points.h"
#include "mesh/triangle.h"
#include "method/cell_mesh.h"

namespace raymap {

namespace {

constexpr double kMostPoints = 2e7;

/// Returns about how many points the triangles have in rows: at most half as many more. Flat ones have none.
double countPoints(const CellMesh& mesh, double step) {
  double count = 0.0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::vec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
    if (isFlat({a, b, c})) continue;
    count += triangleArea(a, b, c) / (step * step) + longestSide(a, b, c) / step + 1.0;
  }
  return count;
}

}  // namespace

SurfacePoints surfacePoints(const PackedMesh& mesh, const Grid& grid, double step) {
  CellMesh cells;
  toCellUnits(mesh, grid, cells);
  double count = countPoints(cells, step);
  while (count > kMostPoints + double(mesh.triangles.size())) {
    step *= 1.5;
    count = countPoints(cells, step);
  }
  SurfacePoints points;
  std::vector<bool> isTaken(mesh.vertices.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c)
      if (const uint32_t v = mesh.triangles[t][c]; !isTaken[v]) {
        isTaken[v] = true;
        points.add(cells.vertices[v], t);
      }
    const glm::dvec3 a = cells.corner(t, 0), b = cells.corner(t, 1), c = cells.corner(t, 2);
    if (!isFlat({a, b, c})) forEachFacePoint(a, b, c, step, [&](const glm::dvec3& p) { points.add(p, t); });
  }
  return points;
}

std::vector<double> areasOfPoints(const PackedMesh& mesh, const SurfacePoints& points) {
  std::vector<double> areas(mesh.triangles.size());
  std::vector<uint32_t> counts(mesh.triangles.size());
  for (const uint32_t face : points.faces) ++counts[face];
  for (uint32_t face = 0; face < areas.size(); ++face) {
    const auto [a, b, c] = mesh.corners(mesh.triangles[face]);
    if (counts[face] > 0) areas[face] = triangleArea(a, b, c) / counts[face];
  }
  return areas;
}

std::vector<float> distancesTo(const PackedMesh& mesh, const Grid& grid, std::span<const glm::vec3> points,
                               Progress& progress) {
  const cpu::CloseDistances search(mesh, grid, INFINITY);
  std::vector<float> distances;
  distances.reserve(points.size());
  forEachPart(points, grid, [&](std::span<const glm::vec3>, std::span<const glm::dvec3> part) {
    progress.report(double(distances.size()) / double(points.size()));
    const QueryResult found = search.measure(part);
    for (const double d : found.distance) distances.push_back(static_cast<float>(d / grid.spacing));
  });
  return distances;
}

Deviation summarize(std::vector<AreaDistance>& found, double spacing) {
  Deviation result;
  result.points = found.size();
  if (found.empty()) return result;
  std::ranges::sort(found, {}, &AreaDistance::distance);
  double area = 0.0, sum = 0.0, below = 0.0;
  for (const auto& [distance, part] : found) area += part, sum += distance * part;
  const auto percentile =
      std::ranges::find_if(found, [&](const AreaDistance& f) { return (below += f.area) >= 0.99 * area; });
  result.max = spacing * double(found.back().distance);
  result.p99 = spacing * double(percentile->distance);
  result.mean = area > 0.0 ? spacing * sum / area : 0.0;
  return result;
}

}  // namespace raymap
