#pragma once

#include <glm/glm.hpp>

namespace raymap {

/// Most times that a face is halved: it has at most 2^22 parts.
inline constexpr int kMostFaceHalvings = 22;

/// Calls `visit(a, b, c)` with the corners of the parts of a triangle, which is halved at the middle of its
/// longest side until none is longer than `step`. Slivers have fewer parts than by an even cut. They wind as
/// the triangle.
template <class Visit>
void forEachFacePart(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, double step, Visit&& visit,
                     int halvings = kMostFaceHalvings) {
  const double ab = glm::distance(a, b), bc = glm::distance(b, c), ca = glm::distance(c, a);
  // The longest side becomes ab.
  if (bc > ab && bc >= ca) return forEachFacePart(b, c, a, step, visit, halvings);
  if (ca > ab) return forEachFacePart(c, a, b, step, visit, halvings);
  if (ab <= step || halvings == 0) return visit(a, b, c);
  const glm::vec3 middle = 0.5f * (a + b);
  forEachFacePart(a, middle, c, step, visit, halvings - 1);
  forEachFacePart(middle, b, c, step, visit, halvings - 1);
}

}  // namespace raymap
