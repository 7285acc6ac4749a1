// The thickness of a mesh's thinnest part, for the verdict on it.

#include <raymap/surface.h>
#include <raymap/thickness.h>
#include <raymap/verdict.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

namespace {

constexpr size_t kPoints = 5000;
constexpr double kLeftOut = 0.002;  // Share of the area that may be thinner.

double areaOf(const PackedMesh& mesh, const glm::uvec3& face) {
  const glm::dvec3 a(mesh.vertices[face.x]), b(mesh.vertices[face.y]), c(mesh.vertices[face.z]);
  return 0.5 * glm::length(glm::cross(b - a, c - a));
}

/// Returns the point of a face with two coordinates in [0, 1). Such points spread evenly if the coordinates
/// do.
glm::dvec3 pointOf(const PackedMesh& mesh, const glm::uvec3& face, double u, double v) {
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const glm::dvec3 a = mesh.position(face.x), b = mesh.position(face.y), c = mesh.position(face.z);
  return a + u * (b - a) + v * (c - a);
}

/// Returns points that stand for equal areas. Places within a face follow the R2 sequence (Roberts 2018).
std::vector<FacePoint> spreadPoints(const PackedMesh& mesh) {
  double total = 0.0;
  for (const glm::uvec3& face : mesh.triangles) total += areaOf(mesh, face);
  const double each = total / double(kPoints);
  std::vector<FacePoint> points;
  if (!(each > 0.0)) return points;
  double before = 0.0;
  for (uint32_t f = 0; f < mesh.triangles.size() && points.size() < kPoints; ++f) {
    before += areaOf(mesh, mesh.triangles[f]);
    for (; points.size() < kPoints && (double(points.size()) + 0.5) * each <= before;) {
      const auto k = double(points.size());
      const double u = k * 0.7548776662466927, v = k * 0.5698402909980532;
      points.push_back({pointOf(mesh, mesh.triangles[f], u - std::floor(u), v - std::floor(v)), f, each});
    }
  }
  return points;
}

/// Rounds a positive number down to two digits.
double roundDown(double number) {
  const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  return std::floor(number / unit * (1.0 + 1e-6)) * unit;
}

}  // namespace

std::optional<double> findThinnest(const MeshView& view, double most, const ProgressCallback& progress) {
  const Surface surface(view, {.progress = progress});
  MeshPacker packer;
  const std::vector<FacePoint> points = spreadPoints(packer.pack(surface.mesh()));
  std::vector<float> diameters;
  for (const Thickness& t : surface.thickness(points, {.most = most, .progress = progress}))
    if (t.part == Part::Wall) diameters.push_back(t.diameter);
  const auto leftOut = size_t(kLeftOut * double(points.size()));
  if (diameters.size() <= leftOut) return {};
  std::ranges::nth_element(diameters, diameters.begin() + ptrdiff_t(leftOut));
  return double(diameters[leftOut]);
}

Verdict judge(const MeshView& mesh, const Diagnostics& found, const SelfIntersections& crossings,
              const ProgressCallback& progress) {
  constexpr size_t kMostTriangles = 2'000'000;  // They take a second or two.
  Verdict verdict = judge(found, crossings);
  const bool isSolid = verdict.kind != MeshKind::NoSurface && verdict.remedy != Remedy::Thicken;
  if (!isSolid || found.triangles > kMostTriangles) return verdict;
  const glm::dvec3 size = found.bounds.size();
  verdict.sought = std::max({size.x, size.y, size.z}) / 25.0;
  verdict.thinnest = findThinnest(mesh, verdict.sought, progress);
  if (verdict.thinnest && *verdict.thinnest > 0.0) verdict.voxelSize = roundDown(0.5 * *verdict.thinnest);
  return verdict;
}

}  // namespace raymap
