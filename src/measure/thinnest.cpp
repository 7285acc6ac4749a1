// The thickness of a mesh's thinnest part, for the verdict on it.

#include "measure/thinnest.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/text.h"
#include "measure/spread_points.h"

namespace raymap {

namespace {

constexpr size_t kPoints = 5000;
constexpr double kMostLeftOut = 0.002;  // Share of the area that may be thinner.

}  // namespace

std::optional<double> findThinnest(const MeshView& view, double maxThickness, const MachineOptions& machine) {
  const Surface surface(view, {}, machine);
  const std::vector<FacePoint> points = spreadPoints(surface.mesh(), kPoints);
  std::vector<float> diameters;
  for (const Thickness& t : surface.thickness(points, {.maxThickness = maxThickness}, machine))
    if (t.part == Part::Wall) diameters.push_back(t.diameter);
  const auto leftOut = size_t(kMostLeftOut * double(points.size()));
  if (diameters.size() <= leftOut) return {};
  std::ranges::nth_element(diameters, diameters.begin() + ptrdiff_t(leftOut));
  return double(diameters[leftOut]);
}

void addThinnest(const MeshView& mesh, const Diagnostics& found, const MachineOptions& machine,
                 Verdict& verdict) {
  constexpr size_t kMostTriangles = 2'000'000;  // They take a second or two.
  if (!hasThickness(verdict) || found.triangles > kMostTriangles) return;
  const glm::dvec3 size = found.bounds.size();
  verdict.sought = std::max({size.x, size.y, size.z}) / 25.0;
  verdict.thinnest = findThinnest(mesh, verdict.sought, machine);
  if (verdict.thinnest && *verdict.thinnest > 0.0) verdict.voxelSize = roundDown(0.5 * *verdict.thinnest);
}

Verdict judge(const MeshView& mesh, const Diagnostics& found, const SelfIntersections& crossings,
              const MachineOptions& machine) {
  Verdict verdict = judge(found, crossings, arrangeParts(mesh, found, crossings, machine));
  addThinnest(mesh, found, machine, verdict);
  return verdict;
}

}  // namespace raymap
