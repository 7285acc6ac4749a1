#include "mesh/polygon.h"

#include <algorithm>
#include <cmath>

#include "mesh/polygon_sweep.h"

namespace raymap {

namespace {

/// Rounding of the positions in files, as a share of a polygon's extent.
constexpr double kNoise = 1e-6;

/// A polygon relative to its first corner, with an extent of 1.
class ScaledPolygon {
 public:
  explicit ScaledPolygon(std::span<const glm::dvec3> corners) : corners_(corners) {
    for (const glm::dvec3& p : corners) {
      const glm::dvec3 d = glm::abs(p - corners[0]);
      extent_ = std::max({extent_, d.x, d.y, d.z});
      if (!std::isfinite(d.x + d.y + d.z)) extent_ = INFINITY;
    }
    scale_ = 1.0 / extent_;
    for (size_t c = 2; c < size(); ++c) area_ += glm::cross((*this)[c - 1], (*this)[c]);
  }

  size_t size() const { return corners_.size(); }
  double extent() const { return extent_; }
  bool isFinite() const { return std::isfinite(extent_) && (extent_ == 0.0 || std::isfinite(scale_)); }
  glm::dvec3 operator[](size_t corner) const { return (corners_[corner] - corners_[0]) * scale_; }
  /// Returns twice the area vector.
  const glm::dvec3& area() const { return area_; }

 private:
  std::span<const glm::dvec3> corners_;
  double extent_ = 0.0, scale_ = 0.0;
  glm::dvec3 area_{0.0};
};

/// Returns whether all triangles of a fan clearly have an area and turn the way of the polygon, and go around
/// the first corner less than once. Ignores triangles at a corner that repeats. Rounding may give a
/// triangle a tiny area whose corners lie on a line; needles are the triangles of a polygon that is one.
bool isClearFan(const ScaledPolygon& polygon, const glm::dvec3& normal) {
  constexpr double kClear = 1e-5;
  const double whole = glm::length(polygon.area());
  const size_t last = polygon.size() - 1;
  const size_t first = polygon[1] != polygon[0] ? 1 : 2;
  bool isBehind = false;
  for (size_t c = first + 1; c <= last; ++c) {
    if (polygon[c] == polygon[c - 1] || (c == last && polygon[c] == polygon[0])) continue;
    const glm::dvec3 before = polygon[c - 1], at = polygon[c], edge = at - before;
    const double longest = std::max({glm::dot(before, before), glm::dot(at, at), glm::dot(edge, edge)});
    if (!(glm::dot(glm::cross(before, at), normal) > kClear * std::min(longest, whole))) return false;
    const double side = glm::dot(glm::cross(polygon[first], polygon[c]), normal);
    if (isBehind && side >= 0.0) return false;
    isBehind = side < 0.0;
  }
  return true;
}

/// Returns the corners in the plane of the area vector, where the polygon is counter-clockwise. A coordinate
/// is left out, which keeps the others exact. Corners off the plane are first moved into it.
std::vector<glm::dvec2> flattened(std::span<const glm::dvec3> corners, const ScaledPolygon& polygon,
                                  const glm::dvec3& normal) {
  const glm::dvec3 size = glm::abs(normal);
  const int left = size.z >= size.x && size.z >= size.y ? 2 : size.y >= size.x ? 1 : 0;
  int u = (left + 1) % 3, v = (left + 2) % 3;
  if (normal[left] < 0.0) std::swap(u, v);
  bool isFlat = true;
  for (size_t c = 0; c < corners.size(); ++c)
    isFlat = isFlat && std::abs(glm::dot(polygon[c], normal)) <= kNoise;
  std::vector<glm::dvec2> flat;
  flat.reserve(corners.size());
  // Exact signs need magnitudes that do not overflow.
  glm::dvec3 largest(0.0);
  for (const glm::dvec3& p : corners) largest = glm::max(largest, glm::abs(p));
  int exponent = 0;
  std::frexp(std::max({largest.x, largest.y, largest.z}), &exponent);
  for (size_t c = 0; c < corners.size(); ++c) {
    glm::dvec3 p = corners[c];
    if (!isFlat) p -= glm::dot(polygon[c], normal) * polygon.extent() * normal;
    flat.emplace_back(std::ldexp(p[u], -exponent), std::ldexp(p[v], -exponent));
  }
  return flat;
}

/// Cuts a polygon with an area by a sweep. Returns false if it crosses itself.
bool sweep(std::span<const glm::dvec3> corners, const ScaledPolygon& polygon, const glm::dvec3& normal,
           std::vector<glm::uvec3>& triangles) {
  const std::vector<glm::dvec2> flat = flattened(corners, polygon, normal);
  glm::dvec2 low(INFINITY), high(-INFINITY);
  for (const glm::dvec2& p : flat) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const double noise = kNoise * std::max(high.x - low.x, high.y - low.y);
  return sweepPolygon(flat, 0.0, triangles) || sweepPolygon(flat, noise, triangles);
}

}  // namespace

PolygonCut cutPolygon(std::span<const glm::dvec3> corners, std::vector<glm::uvec3>& triangles) {
  constexpr double kNoArea = 1e-14;
  PolygonCut cut = PolygonCut::Fan;
  if (corners.size() > 3) {
    const ScaledPolygon polygon(corners);
    const double area = glm::length(polygon.area());
    const glm::dvec3 normal = polygon.area() / area;
    if (polygon.isFinite() && !(area > kNoArea))
      cut = PolygonCut::None;
    else if (polygon.isFinite() && !isClearFan(polygon, normal))
      cut = sweep(corners, polygon, normal, triangles) ? PolygonCut::Swept : PolygonCut::None;
  }
  if (cut != PolygonCut::Swept)
    for (uint32_t c = 2; c < corners.size(); ++c) triangles.emplace_back(0, c - 1, c);
  return cut;
}

}  // namespace raymap
