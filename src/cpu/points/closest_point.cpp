#include "cpu/points/closest_point.h"

#include <algorithm>
#include <iterator>

namespace raymap::cpu {

namespace {

/// Triangles whose squared sine at a corner is below this are slivers. Their normals may be rounding errors.
constexpr double kSliver = 1e-16;

double squaredLength(const glm::dvec3& v) {
  return glm::dot(v, v);
}

/// Returns where on the segment from a to b the point closest to p lies, 0 at a and 1 at b.
double placeOnSegment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 e = b - a;
  const double length2 = squaredLength(e);
  return length2 > 0.0 ? std::clamp(glm::dot(p - a, e) / length2, 0.0, 1.0) : 0.0;
}

TrianglePoint closestOnEdges(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                             const glm::dvec3& c) {
  const double ab = placeOnSegment(p, a, b), bc = placeOnSegment(p, b, c), ca = placeOnSegment(p, c, a);
  const TrianglePoint points[] = {{a + ab * (b - a), {1.0 - ab, ab, 0.0}},
                                  {b + bc * (c - b), {0.0, 1.0 - bc, bc}},
                                  {c + ca * (a - c), {ca, 0.0, 1.0 - ca}}};
  return *std::min_element(std::begin(points), std::end(points),
                           [&](const TrianglePoint& l, const TrianglePoint& r) {
                             return squaredLength(l.position - p) < squaredLength(r.position - p);
                           });
}

}  // namespace

TrianglePoint closestPoint(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                           const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const glm::dvec3 normal = glm::cross(ab, ac);
  const double area2 = squaredLength(normal);
  // Weights of b and c at the projection of p, times area2.
  const double wb = glm::dot(glm::cross(ap, ac), normal), wc = glm::dot(glm::cross(ab, ap), normal);
  if (!(area2 > 0.0) || wb < 0.0 || wc < 0.0 || wb + wc > area2) return closestOnEdges(p, a, b, c);
  const double v = wb / area2, w = wc / area2;
  const TrianglePoint inside{a + v * ab + w * ac, {1.0 - v - w, v, w}};
  if (area2 > kSliver * squaredLength(ab) * squaredLength(ac)) return inside;
  const TrianglePoint edge = closestOnEdges(p, a, b, c);
  return squaredLength(inside.position - p) < squaredLength(edge.position - p) ? inside : edge;
}

}  // namespace raymap::cpu
