#include "predicates/line_triangle.h"

#include <algorithm>

namespace raymap {

namespace {

/// Returns twice the area of the triangle of the origin and an edge. The same edge taken backwards gives
/// exactly the negative, which needs a compiler that does not fuse operations.
double edgeArea(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// Returns the side of an edge on which the origin lies, +1 or -1. 0 only if a = b.
int sideOf(const glm::dvec2& a, const glm::dvec2& b) {
  const auto sign = [](double v) { return (v > 0.0) - (v < 0.0); };
  if (const int side = sign(edgeArea(a, b)); side != 0) return side;
  if (const int side = sign(b.y - a.y); side != 0) return side;
  return sign(a.x - b.x);
}

}  // namespace

LinePassage passLine(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  const int side = sideOf(a, b);
  if (side == 0 || sideOf(b, c) != side || sideOf(c, a) != side) return {};
  return {side, {edgeArea(b, c), edgeArea(c, a), edgeArea(a, b)}};
}

std::optional<double> crossingAt(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double y,
                                 double z) {
  // Turned by 180 degrees, which turns the infinitely small step too.
  const auto turned = [&](const glm::dvec3& p) { return glm::dvec2(y - p.y, z - p.z); };
  if (passLine(turned(a), turned(b), turned(c)).side == 0) return {};
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  if (normal.x == 0.0) return a.x;  // By rounding alone.
  const auto [low, high] = std::minmax({a.x, b.x, c.x});
  return std::clamp(a.x - (normal.y * (y - a.y) + normal.z * (z - a.z)) / normal.x, low, high);
}

}  // namespace raymap
