#include "mesh/edge_flips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "predicates/turn.h"

namespace raymap {

namespace {

constexpr uint32_t kNone = UINT32_MAX;

/// Returns whether `d` clearly lies in the circle through `a`, `b` and `c`.
bool isInCircle(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
  constexpr double kClear = 1e-10;
  const glm::dvec2 u = a - d, v = b - d, w = c - d;
  const double x = glm::dot(u, u) * (v.x * w.y - v.y * w.x), y = glm::dot(v, v) * (w.x * u.y - w.y * u.x),
               z = glm::dot(w, w) * (u.x * v.y - u.y * v.x);
  return x + y + z > kClear * (std::abs(x) + std::abs(y) + std::abs(z));
}

/// Half edge 3 t + k goes from corner k of triangle t to the next.
class EdgeFlips {
 public:
  EdgeFlips(std::span<const glm::dvec2> corners, std::vector<glm::uvec3>& triangles)
      : corners_(corners), triangles_(triangles), twins_(3 * triangles.size(), kNone) {
    pairUp();
  }

  void run() {
    constexpr size_t kMostPerTriangle = 32;
    size_t most = kMostPerTriangle * triangles_.size();
    std::vector<uint32_t> edges;
    for (uint32_t edge = 0; edge < twins_.size(); ++edge) edges.push_back(edge);
    while (!edges.empty() && most > 0) {
      const uint32_t edge = edges.back();
      edges.pop_back();
      if (twins_[edge] == kNone || !isThin(edge)) continue;
      --most;
      for (const uint32_t outer : flip(edge)) edges.push_back(outer);
    }
  }

 private:
  static uint32_t next(uint32_t edge) { return edge % 3 == 2 ? edge - 2 : edge + 1; }
  uint32_t from(uint32_t edge) const { return triangles_[edge / 3][static_cast<int>(edge % 3)]; }
  uint32_t opposite(uint32_t edge) const { return from(next(next(edge))); }

  /// Finds the half edge the other way of each, unless there are several.
  void pairUp() {
    std::vector<uint32_t> order(twins_.size());
    for (uint32_t edge = 0; edge < order.size(); ++edge) order[edge] = edge;
    const auto ends = [&](uint32_t edge) { return std::minmax({from(edge), from(next(edge))}); };
    std::ranges::sort(
        order, [&](uint32_t a, uint32_t b) { return std::tuple(ends(a), a) < std::tuple(ends(b), b); });
    for (size_t i = 0, end = 0; i < order.size(); i = end) {
      while (end < order.size() && ends(order[end]) == ends(order[i])) ++end;
      if (end - i != 2 || from(order[i]) == from(order[i + 1])) continue;
      twins_[order[i]] = order[i + 1];
      twins_[order[i + 1]] = order[i];
    }
  }

  bool isThin(uint32_t edge) const {
    const glm::dvec2 &a = corners_[from(edge)], &b = corners_[from(next(edge))],
                     &c = corners_[opposite(edge)], &d = corners_[opposite(twins_[edge])];
    return isInCircle(a, b, c, d) && turn(a, d, c) > 0 && turn(d, b, c) > 0;
  }

  void join(uint32_t edge, uint32_t twin) {
    twins_[edge] = twin;
    if (twin != kNone) twins_[twin] = edge;
  }

  /// Returns the four edges around the flipped one.
  std::array<uint32_t, 4> flip(uint32_t edge) {
    const uint32_t twin = twins_[edge], t = 3 * (edge / 3), u = 3 * (twin / 3);
    const uint32_t a = from(edge), b = from(twin), c = opposite(edge), d = opposite(twin);
    const uint32_t bc = twins_[next(edge)], ca = twins_[next(next(edge))], ad = twins_[next(twin)],
                   db = twins_[next(next(twin))];
    triangles_[t / 3] = {a, d, c};
    triangles_[u / 3] = {d, b, c};
    join(t, ad);
    join(t + 1, u + 2);
    join(t + 2, ca);
    join(u, db);
    join(u + 1, bc);
    return {t, t + 2, u, u + 1};
  }

  std::span<const glm::dvec2> corners_;
  std::vector<glm::uvec3>& triangles_;
  std::vector<uint32_t> twins_;
};

}  // namespace

void flipThinTriangles(std::span<const glm::dvec2> corners, std::vector<glm::uvec3>& triangles) {
  EdgeFlips(corners, triangles).run();
}

}  // namespace raymap
