#pragma once

// Points on faces, as the middles of the parts that a triangle is cut into:
// - parts: each is a triangle. For points that stand for an area, and parts that become faces.
// - rows: neighbours are at most a step apart, and there are as few points as the area allows.

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

#include "mesh/triangle.h"

namespace raymap {

/// Returns the number of parts, at least 1, into which a length must be cut so that none exceeds `step`.
inline int partsOf(double length, double step) {
  return static_cast<int>(std::clamp(std::ceil(length / step), 1.0, 1e6));
}

/// Visits the middles of the parts of an evenly cut segment.
template <class Visit>
void forEachEdgePoint(const glm::dvec3& a, const glm::dvec3& b, int parts, Visit&& visit) {
  for (int k = 0; k < parts; ++k) visit(glm::mix(a, b, (k + 0.5) / parts));
}

/// Most times that a face is halved: it has at most 2^22 parts.
inline constexpr int kMostFaceHalvings = 22;

/// Calls `visit(a, b, c)` with the corners of the parts of a triangle that is cut into strips between the
/// sides ab and ac. They wind as the triangle.
template <class Visit>
void forEachStripPart(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, int strips, Visit&& visit) {
  for (int k = 0; k < strips; ++k) {
    const float low = float(k) / float(strips), high = float(k + 1) / float(strips);
    const glm::vec3 corner = glm::mix(a, b, low), opposite = glm::mix(a, c, high);
    visit(corner, glm::mix(a, b, high), opposite);
    if (k > 0) visit(corner, opposite, glm::mix(a, c, low));
  }
}

/// Does the work of `forEachFacePart` for lengths whose squares fit in single precision.
template <class Visit>
void halveFace(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, double step, Visit&& visit,
               int halvings) {
  constexpr double kNarrow = 0.5;  // Height of a narrow triangle over its longest side, in steps.
  const double ab = glm::distance(a, b), bc = glm::distance(b, c), ca = glm::distance(c, a);
  // The longest side becomes ab.
  if (bc > ab && bc >= ca) return halveFace(b, c, a, step, visit, halvings);
  if (ca > ab) return halveFace(c, a, b, step, visit, halvings);
  if (ab <= step || halvings == 0) return visit(a, b, c);
  if (const double height = glm::length(doubleAreaNormal(a, b, c)) / ab; height <= kNarrow * step) {
    const float along = glm::clamp(glm::dot(c - a, b - a) / float(ab * ab), 0.0f, 1.0f);
    const glm::vec3 foot = glm::mix(a, b, along);
    const double width = std::sqrt(step * step - height * height);
    const int most = 1 << std::max(halvings - 2, 0);
    const auto stripsOf = [&](double length) { return std::min(partsOf(length, width), most); };
    if (foot != a) forEachStripPart(a, foot, c, stripsOf(ab * along), visit);
    if (foot != b) forEachStripPart(b, c, foot, stripsOf(ab * (1.0 - along)), visit);
    return;
  }
  const glm::vec3 middle = 0.5f * (a + b);
  halveFace(a, middle, c, step, visit, halvings - 1);
  halveFace(middle, b, c, step, visit, halvings - 1);
}

/// Parts: calls `visit(a, b, c)` with the corners of the parts of a triangle, of which no side is longer than
/// `step`. They wind as the triangle. It is halved at the middle of its longest side until it is narrow, and
/// then cut into strips: halves of a sliver are three slivers of half its length, and so on.
template <class Visit>
void forEachFacePart(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, double step, Visit&& visit,
                     int halvings = kMostFaceHalvings) {
  // A power of two scales without rounding, and brings the step to about 1.
  const float scale = step > 0.0 ? std::ldexp(1.0f, -std::clamp(std::ilogb(step), -126, 126)) : 1.0f;
  halveFace(
      scale * a, scale * b, scale * c, double(scale) * step,
      [&](const glm::vec3& p, const glm::vec3& q, const glm::vec3& r) {
        visit(p / scale, q / scale, r / scale);
      },
      halvings);
}

/// Rows: visits points of a triangle in rows along its longest side. Neighbours are at most `step` apart, and
/// the number of points is about the area in squares of it.
template <class Visit>
void forEachFacePoint(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double step,
                      Visit&& visit) {
  std::array<glm::dvec3, 3> p{a, b, c};
  const auto length = [&](size_t k) { return glm::distance(p[k], p[(k + 1) % 3]); };
  size_t longest = 0;
  for (size_t k = 1; k < 3; ++k)
    if (length(k) > length(longest)) longest = k;
  std::rotate(p.begin(), p.begin() + ptrdiff_t(longest), p.end());
  const double base = glm::distance(p[0], p[1]);
  const double height = base > 0.0 ? glm::length(doubleAreaNormal(p[0], p[1], p[2])) / base : 0.0;
  const int rows = partsOf(height, step);
  for (int row = 0; row < rows; ++row) {
    const double up = (row + 0.5) / rows;
    forEachEdgePoint(glm::mix(p[0], p[2], up), glm::mix(p[1], p[2], up), partsOf(base * (1.0 - up), step),
                     visit);
  }
}

}  // namespace raymap
