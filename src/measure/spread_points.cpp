#include "measure/spread_points.h"

#include <raymap/error.h>
#include <raymap/mesh_thickness.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/memory.h"
#include "mesh/face_points.h"
#include "mesh/model.h"
#include "mesh/triangle.h"

namespace raymap {

namespace {

double areaOf(const PackedMesh& mesh, const glm::uvec3& face) {
  const auto [a, b, c] = mesh.corners(face);
  return triangleArea(a, b, c);
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

/// Returns fewer parts than a face is halved into, or as many: the largest part is an equilateral triangle.
double leastParts(const PackedMesh& mesh, const glm::uvec3& face, double step) {
  const auto [a, b, c] = mesh.corners(face);
  const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  const double byArea = areaOf(mesh, face) / (std::sqrt(0.1875) * step * step);
  return std::clamp(std::max(byArea, longest / step), 1.0, double(1 << kMostFaceHalvings));
}

/// Throws `Error(Memory)` if the points do not fit.
void checkPoints(const PackedMesh& mesh, double step) {
  double count = 0.0;
  for (const glm::uvec3& face : mesh.triangles) count += leastParts(mesh, face, step);
  const auto needed = static_cast<uint64_t>(count * sizeof(FacePoint));
  if (const uint64_t limit = memoryLeft(); needed > limit)
    throw Error(ErrorCode::Memory, "the points on the faces need " + neededText(needed) + ", but " +
                                       limitText(limit) + " are available; use a larger step");
}

}  // namespace

std::vector<FacePoint> spreadPoints(const MeshView& view, size_t count) {
  const Model mesh(view);
  double total = 0.0;
  for (const glm::uvec3& face : mesh.triangles) total += areaOf(mesh, face);
  const double each = total / double(count);
  std::vector<FacePoint> points;
  if (!(each > 0.0)) return points;
  double before = 0.0;
  for (uint32_t f = 0; f < mesh.triangles.size() && points.size() < count; ++f) {
    before += areaOf(mesh, mesh.triangles[f]);
    for (; points.size() < count && (double(points.size()) + 0.5) * each <= before;) {
      const auto k = double(points.size());
      const double u = k * 0.7548776662466927, v = k * 0.5698402909980532;
      points.push_back({pointOf(mesh, mesh.triangles[f], u - std::floor(u), v - std::floor(v)), f, each});
    }
  }
  return points;
}

std::vector<FacePoint> sampleFaces(const MeshView& view, double step) {
  const Model mesh(view);
  checkPoints(mesh, step);
  std::vector<FacePoint> points;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& face = mesh.triangles[t];
    forEachFacePart(mesh.vertices[face.x], mesh.vertices[face.y], mesh.vertices[face.z], step,
                    [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
                      points.push_back({mesh.origin + (a + b + c) / 3.0, t, triangleArea(a, b, c)});
                    });
  }
  return points;
}

}  // namespace raymap
