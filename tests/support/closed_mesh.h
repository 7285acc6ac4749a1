#pragma once

// Checks that a mesh bounds a solid.

#include <gtest/gtest.h>
#include <raymap/mesh.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace raymap {

/// A face's corner, the one after it and the one before.
struct Wedge {
  uint32_t corner, next, before;
};

/// Returns whether the faces around a vertex, in any order, form one ring.
inline bool isRing(const Wedge* begin, const Wedge* end) {
  uint32_t at = begin->next;
  ptrdiff_t steps = 0;
  do {
    const Wedge* wedge = std::find_if(begin, end, [&](const Wedge& w) { return w.next == at; });
    if (wedge == end) return false;
    at = wedge->before;
    ++steps;
  } while (at != begin->next && steps <= end - begin);
  return steps == end - begin;
}

/// Checks that exactly two faces use every edge, in opposite directions, and that the faces around every
/// vertex form one ring.
inline testing::AssertionResult isClosed(const Mesh& mesh) {
  std::vector<Wedge> wedges;
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) wedges.push_back({t[c], t[(c + 1) % 3], t[(c + 2) % 3]});
  const auto isBefore = [](const Wedge& v, const Wedge& w) {
    return std::pair(v.corner, v.next) < std::pair(w.corner, w.next);
  };
  std::sort(wedges.begin(), wedges.end(), isBefore);
  const auto uses = [&](uint32_t a, uint32_t b) {
    const auto [first, last] = std::equal_range(wedges.begin(), wedges.end(), Wedge{a, b, 0}, isBefore);
    return last - first;
  };
  for (const Wedge& w : wedges)
    if (w.corner == w.next || uses(w.corner, w.next) != 1 || uses(w.next, w.corner) != 1)
      return testing::AssertionFailure()
             << "edge " << w.corner << " " << w.next << " is used " << uses(w.corner, w.next) << " and "
             << uses(w.next, w.corner) << " times";
  for (size_t begin = 0, end = 0; begin < wedges.size(); begin = end) {
    while (end < wedges.size() && wedges[end].corner == wedges[begin].corner) ++end;
    if (!isRing(wedges.data() + begin, wedges.data() + end))
      return testing::AssertionFailure()
             << "the faces around vertex " << wedges[begin].corner << " are no ring";
  }
  return testing::AssertionSuccess();
}

inline double volumeOf(const Mesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.vertices[t.x]), b(mesh.vertices[t.y]), c(mesh.vertices[t.z]);
    sum += glm::dot(a, glm::cross(b, c));
  }
  return sum / 6.0;
}

}  // namespace raymap
