#include <raymap/mesh_thickness.h>

#include <algorithm>
#include <cmath>

#include "measure/spread_points.h"

namespace raymap {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Number of points that a summary measures.
constexpr size_t kSummaryPoints = 100'000;

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

ThicknessSummary summarizeThickness(const Surface& surface, const ThicknessOptions& options,
                                    const MachineOptions& machine) {
  const std::vector<FacePoint> points = spreadPoints(surface.mesh(), kSummaryPoints);
  return summarizeThickness(points, surface.thickness(points, options, machine));
}

}  // namespace raymap
