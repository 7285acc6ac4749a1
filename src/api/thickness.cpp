#include <raymap/surface.h>
#include <raymap/thickness.h>

#include <algorithm>
#include <cmath>

#include "mesh/face_parts.h"
#include "mesh/packed_mesh.h"

namespace raymap {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Number of points that a summary measures.
constexpr size_t kSummaryPoints = 100'000;

double areaOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return 0.5 * glm::length(glm::cross(b - a, c - a));
}

/// Returns points spread evenly over the area of a mesh, in the order of the faces.
std::vector<FacePoint> spreadPoints(const PackedMesh& mesh, size_t count) {
  // The plastic sequence (Roberts 2018) fills a triangle evenly.
  constexpr double kFirst = 0.7548776662466927, kSecond = 0.5698402909980532;
  double total = 0.0;
  for (const glm::uvec3& t : mesh.triangles)
    total += areaOf(mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]);
  std::vector<FacePoint> points;
  points.reserve(count);
  double sum = 0.0;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    const glm::dvec3 a(mesh.vertices[t.x]), b(mesh.vertices[t.y]), c(mesh.vertices[t.z]);
    sum += areaOf(a, b, c);
    while (points.size() < count && (double(points.size()) + 0.5) * total < sum * double(count)) {
      const auto k = double(points.size() + 1);
      double u = k * kFirst - std::floor(k * kFirst), v = k * kSecond - std::floor(k * kSecond);
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      points.push_back({mesh.origin + a + u * (b - a) + v * (c - a), f, total / double(count)});
    }
  }
  return points;
}

/// Thinnest point of one kind.
struct Thinnest {
  double diameter = INFINITY;
  glm::dvec3 position{kNaN};

  void take(double newDiameter, const glm::dvec3& p) {
    if (newDiameter < diameter) diameter = newDiameter, position = p;
  }
  double value() const { return std::isinf(diameter) ? kNaN : diameter; }
};

/// Diameters and the area that each stands for.
class AreaDistribution {
 public:
  void add(double diameter, double area) {
    values_.emplace_back(diameter, area);
    total_ += area;
  }
  void sort() { std::ranges::sort(values_); }
  /// Returns the least diameter that this share of the area does not exceed.
  double quantile(double share) const {
    double sum = 0.0;
    for (const auto& [diameter, area] : values_)
      if (sum += area; sum >= share * total_) return diameter;
    return kNaN;
  }

 private:
  std::vector<std::pair<double, double>> values_;
  double total_ = 0.0;
};

}  // namespace

std::vector<FacePoint> sampleFaces(const MeshView& view, double step) {
  MeshPacker packer;
  const PackedMesh mesh = packer.pack(view);
  std::vector<FacePoint> points;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& face = mesh.triangles[t];
    forEachFacePart(mesh.vertices[face.x], mesh.vertices[face.y], mesh.vertices[face.z], step,
                    [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
                      points.push_back({mesh.origin + (a + b + c) / 3.0, t, areaOf(a, b, c)});
                    });
  }
  return points;
}

ThicknessSummary summarizeThickness(std::span<const FacePoint> points, std::span<const Thickness> thickness) {
  Thinnest wall, edge;
  AreaDistribution distribution;
  double total = 0.0, sheets = 0.0, buried = 0.0;
  for (size_t i = 0; i < points.size(); ++i) {
    const double diameter = thickness[i].diameter, area = points[i].area;
    const Part part = thickness[i].part;
    total += area;
    if (part == Part::Sheet) sheets += area;
    if (part == Part::Buried) buried += area;
    if (part == Part::Wall) wall.take(diameter, points[i].position);
    if (part == Part::Edge) edge.take(diameter, points[i].position);
    if (part == Part::Wall || part == Part::Edge) distribution.add(diameter, area);
  }
  distribution.sort();
  const auto share = [&](double area) { return total > 0.0 ? area / total : 0.0; };
  return {wall.value(),
          wall.position,
          edge.value(),
          edge.position,
          distribution.quantile(0.01),
          distribution.quantile(0.5),
          share(sheets),
          share(buried),
          points.size()};
}

ThicknessSummary summarizeThickness(const Surface& surface, const ThicknessOptions& options) {
  MeshPacker packer;
  const std::vector<FacePoint> points = spreadPoints(packer.pack(surface.mesh()), kSummaryPoints);
  return summarizeThickness(points, surface.thickness(points, options));
}

}  // namespace raymap
