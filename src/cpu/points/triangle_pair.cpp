#include "cpu/points/triangle_pair.h"

#include <algorithm>

#include "cpu/points/closest_point.h"
#include "mesh/triangle.h"
#include "predicates/segment_triangle.h"

namespace raymap::cpu {

namespace {

TrianglePair pairOf(const glm::dvec3& a, const glm::dvec3& b) {
  return {glm::dot(b - a, b - a), a, b};
}

void take(TrianglePair& best, const TrianglePair& other) {
  if (other.squared < best.squared) best = other;
}

/// Returns where inside both of two segments they are closest; nothing closer than `best` if an end is. The
/// ends themselves are points of triangles.
void meetSegments(const glm::dvec3& a, const glm::dvec3& endOfA, const glm::dvec3& b,
                  const glm::dvec3& endOfB, TrianglePair& best) {
  const glm::dvec3 u = endOfA - a, v = endOfB - b, w = a - b;
  const double uu = glm::dot(u, u), vv = glm::dot(v, v), uv = glm::dot(u, v), uw = glm::dot(u, w),
               vw = glm::dot(v, w);
  const glm::dvec3 across = glm::cross(u, v);  // Its square is uu vv - uv uv, but for cancellation.
  const double area2 = glm::dot(across, across);
  if (!(area2 > 0.0)) return;
  const double s = std::clamp((uv * vw - vv * uw) / area2, 0.0, 1.0),
               t = std::clamp((uv * s + vw) / vv, 0.0, 1.0), again = std::clamp((uv * t - uw) / uu, 0.0, 1.0);
  take(best, pairOf(a + again * u, b + t * v));
}

/// Takes the point where an edge crosses a triangle. `pair(p)` makes the pair of it.
template <class Pair>
bool cross(const Corners& triangle, const glm::dvec3& from, const glm::dvec3& to, Pair&& pair) {
  const auto& [a, b, c] = triangle;
  const int32_t crossing = crossSegment(a, b, c, from, to);
  if (crossing == 0 || crossing == kUnsure) return false;
  const glm::dvec3 normal = doubleAreaNormal(a, b, c);
  const double start = glm::dot(normal, from - a), end = glm::dot(normal, to - a);
  pair(from + start / (start - end) * (to - from));
  return true;
}

}  // namespace

TrianglePair closestPoints(const Corners& a, const Corners& b, bool mayCross) {
  TrianglePair best = pairOf(a[0], closestPoint(a[0], b[0], b[1], b[2]).position);
  for (size_t i = 1; i < 3; ++i) take(best, pairOf(a[i], closestPoint(a[i], b[0], b[1], b[2]).position));
  for (const glm::dvec3& p : b) take(best, pairOf(closestPoint(p, a[0], a[1], a[2]).position, p));
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) meetSegments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3], best);
  const auto meet = [&](const glm::dvec3& p) { best = {0.0, p, p}; };
  for (size_t i = 0; i < 3 && mayCross; ++i)
    if (cross(b, a[i], a[(i + 1) % 3], meet) || cross(a, b[i], b[(i + 1) % 3], meet)) break;
  return best;
}

}  // namespace raymap::cpu
