#include "mesh/plane_triangles.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace raymap {

PlaneTriangles::PlaneTriangles(const ExactPoints& points, int axis) : points_(points), axis_(axis) {
  const glm::uvec3 frame = points.frame(axis);
  add(frame.x, frame.y, frame.z);
}

void PlaneTriangles::add(uint32_t a, uint32_t b, uint32_t c) {
  apexes_[keyOf(a, b)] = c;
  apexes_[keyOf(b, c)] = a;
  apexes_[keyOf(c, a)] = b;
  nexts_[a] = b;
  nexts_[b] = c;
  nexts_[c] = a;
  last_ = {a, b, c};
}

void PlaneTriangles::remove(uint32_t a, uint32_t b, uint32_t c) {
  apexes_.erase(keyOf(a, b));
  apexes_.erase(keyOf(b, c));
  apexes_.erase(keyOf(c, a));
}

/// Walks to the triangle around a point. Starts with another edge at each step, so the walk ends.
glm::uvec3 PlaneTriangles::triangleAround(uint32_t point) const {
  glm::uvec3 t = last_;
  uint32_t random = 1;
  for (;;) {
    random = random * 1664525u + 1013904223u;
    int k = 0;
    for (; k < 3; ++k) {
      const int c = int((random >> 16) + uint32_t(k)) % 3;
      const uint32_t from = t[c], to = t[(c + 1) % 3];
      if (turn(from, to, point) >= 0) continue;
      t = {to, from, apex(to, from)};
      break;
    }
    if (k == 3) return t;
  }
}

void PlaneTriangles::addPoint(uint32_t point) {
  const glm::uvec3 t = triangleAround(point);
  std::vector<Edge> rim;
  remove(t.x, t.y, t.z);
  for (int k = 0; k < 3; ++k) {
    const uint32_t from = t[k], to = t[(k + 1) % 3];
    if (turn(from, to, point) != 0) {
      rim.push_back({from, to});
      continue;
    }
    const uint32_t across = apex(to, from);
    remove(to, from, across);
    rim.push_back({from, across});
    rim.push_back({across, to});
  }
  for (const auto& [from, to] : rim) add(from, to, point);
  improve(std::move(rim));
}

bool PlaneTriangles::canFlip(const Edge& edge) const {
  const uint32_t left = apex(edge[0], edge[1]), right = apex(edge[1], edge[0]);
  return turn(right, left, edge[0]) > 0 && turn(right, left, edge[1]) < 0;
}

PlaneTriangles::Edge PlaneTriangles::flip(const Edge& edge) {
  const auto [from, to] = edge;
  const uint32_t left = apex(from, to), right = apex(to, from);
  remove(from, to, left);
  remove(to, from, right);
  add(from, right, left);
  add(right, to, left);
  return {left, right};
}

/// Returns whether the angles across an edge are more than half a turn together.
bool PlaneTriangles::isSharp(const Edge& edge) const {
  const auto at = [&](uint32_t p) {
    const glm::dvec3& place = points_.rounded(p);
    return glm::dvec2(place[(axis_ + 1) % 3], place[(axis_ + 2) % 3]);
  };
  const glm::dvec2 from = at(edge[0]), to = at(edge[1]);
  glm::dvec2 sine, cosine;
  double scale = 1.0;
  for (int side = 0; side < 2; ++side) {
    const glm::dvec2 p = at(apex(edge[size_t(side)], edge[size_t(1 - side)]));
    const glm::dvec2 a = from - p, b = to - p;
    sine[side] = std::abs(a.x * b.y - a.y * b.x);
    cosine[side] = glm::dot(a, b);
    scale *= glm::length(a) * glm::length(b);
  }
  constexpr double kRounding = 1e-9;
  return sine[0] * cosine[1] + sine[1] * cosine[0] < -kRounding * scale;
}

/// Flips edges, and those around them.
void PlaneTriangles::improve(std::vector<Edge> edges) {
  for (size_t most = 64 * edges.size() + 4096; !edges.empty() && most > 0; --most) {
    const Edge edge = edges.back();
    edges.pop_back();
    if (!hasEdge(edge[0], edge[1]) || !hasEdge(edge[1], edge[0])) continue;
    if (fixed_.contains(keyOf(std::min(edge[0], edge[1]), std::max(edge[0], edge[1])))) continue;
    if (!isSharp(edge) || !canFlip(edge)) continue;
    const auto [left, right] = flip(edge);
    for (const uint32_t end : edge) {
      edges.push_back({end, left});
      edges.push_back({end, right});
    }
  }
}

/// Returns the first edge that the way between two points crosses, from its right to its left.
std::optional<PlaneTriangles::Edge> PlaneTriangles::firstCrossing(uint32_t from, uint32_t to) const {
  const uint32_t first = nexts_.at(from);
  uint32_t right = first;
  do {
    const uint32_t left = apex(from, right);
    if (turn(from, to, right) < 0 && turn(from, to, left) > 0 && turn(right, left, to) < 0)
      return Edge{right, left};
    right = left;
  } while (right != first);
  return {};
}

/// Flips edges that cross the way between two points until none does (Sloan 1993).
bool PlaneTriangles::clearWay(uint32_t from, uint32_t to, std::vector<Edge> crossing) {
  std::vector<Edge> made;
  for (size_t most = (crossing.size() + 4) * (crossing.size() + 4); !crossing.empty(); --most) {
    if (most == 0) return false;
    std::vector<Edge> left;
    for (const Edge& edge : crossing) {
      if (!canFlip(edge)) {
        left.push_back(edge);
        continue;
      }
      const Edge other = flip(edge);
      const auto isEnd = [&](uint32_t p) { return p == from || p == to; };
      const bool crosses =
          !isEnd(other[0]) && !isEnd(other[1]) && turn(from, to, other[0]) * turn(from, to, other[1]) < 0;
      (crosses ? left : made).push_back(other);
    }
    crossing = std::move(left);
  }
  fixed_.insert(keyOf(std::min(from, to), std::max(from, to)));
  improve(std::move(made));
  return true;
}

bool PlaneTriangles::addEdge(uint32_t from, uint32_t to) {
  std::vector<Edge> crossing;
  if (!hasEdge(from, to)) {
    std::optional<Edge> edge = firstCrossing(from, to);
    while (edge) {
      const auto [right, left] = *edge;
      if (fixed_.contains(keyOf(std::min(right, left), std::max(right, left)))) return false;
      crossing.push_back(*edge);
      const uint32_t next = apex(left, right);
      if (next == to) break;
      const int side = turn(from, to, next);
      if (side == 0) return false;
      edge = side > 0 ? Edge{right, next} : Edge{next, left};
    }
    if (!edge) return false;
  }
  return clearWay(from, to, std::move(crossing));
}

std::vector<glm::uvec3> PlaneTriangles::triangles() {
  std::vector<glm::uvec3> all;
  for (const auto& [edge, third] : apexes_) {
    const auto from = uint32_t(edge >> 32), to = uint32_t(edge);
    if (from < to && from < third) all.push_back({from, to, third});
  }
  std::ranges::sort(all, [](const glm::uvec3& a, const glm::uvec3& b) {
    return std::pair(a.x, keyOf(a.y, a.z)) < std::pair(b.x, keyOf(b.y, b.z));
  });
  return all;
}

}  // namespace raymap
