// Triangulates polygons with holes: bridges join the holes to the outline, then ears are cut off.

#include "repair/topology/flat_polygon.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace raymap {

namespace {

// Limits on the work, which takes a second or two.
constexpr size_t kMostCorners = 20'000, kMostBridgeSteps = 20'000'000, kMostEarSteps = 500'000'000;

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// Returns twice the area of a triangle, positive if it is counter-clockwise.
double doubleArea(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return cross(b - a, c - a);
}

double doubleArea(std::span<const FlatCorner> loop) {
  double area = 0.0;
  for (size_t i = 0; i < loop.size(); ++i)
    area += doubleArea(loop[0].position, loop[i].position, loop[(i + 1) % loop.size()].position);
  return area;
}

/// Returns whether a point lies on the closed segment from a to b, which it is on the line of.
bool isBetween(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
  return glm::dot(p - a, p - b) <= 0.0;
}

/// Returns whether two closed segments have a point in common, but for corners that they share.
bool doMeet(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c, const glm::dvec2& d) {
  const auto liesOn = [](const glm::dvec2& p, const glm::dvec2& from, const glm::dvec2& to) {
    return p != from && p != to && doubleArea(from, to, p) == 0.0 && isBetween(p, from, to);
  };
  if (liesOn(a, c, d) || liesOn(b, c, d) || liesOn(c, a, b) || liesOn(d, a, b)) return true;
  return doubleArea(a, b, c) * doubleArea(a, b, d) < 0.0 && doubleArea(c, d, a) * doubleArea(c, d, b) < 0.0;
}

/// Least shape of an ear that may be cut off.
struct Demand {
  double height;  ///< Least height, as a share of its longest side.
  double gap;     ///< Least distance of other corners, as the same share.
};
constexpr Demand kDemands[] = {{1e-3, 1e-6}, {1e-5, 1e-6}, {0.0, 0.0}};

/// A polygon of one loop, whose ears are cut off.
class EarClipper {
 public:
  explicit EarClipper(std::vector<FlatCorner> loop) : corners_(std::move(loop)) {
    const auto count = uint32_t(corners_.size());
    previous_.resize(count), next_.resize(count), isConvex_.resize(count);
    for (uint32_t i = 0; i < count; ++i) previous_[i] = (i + count - 1) % count, next_[i] = (i + 1) % count;
    for (uint32_t i = 0; i < count; ++i) update(i);
  }

  bool run(std::vector<glm::uvec3>& triangles) {
    size_t left = corners_.size();
    uint32_t at = 0;
    for (; left > 3; --left) {
      const std::optional<uint32_t> ear = findEar(at, left);
      if (!ear) return false;
      emit(*ear, triangles);
      const uint32_t before = previous_[*ear], after = next_[*ear];
      next_[before] = after, previous_[after] = before;
      update(before), update(after);
      at = next_[after];
    }
    if (!isConvex_[at]) return false;
    emit(at, triangles);
    return true;
  }

 private:
  const glm::dvec2& position(uint32_t i) const { return corners_[i].position; }

  void update(uint32_t i) {
    isConvex_[i] = doubleArea(position(previous_[i]), position(i), position(next_[i])) > 0.0;
  }

  void emit(uint32_t i, std::vector<glm::uvec3>& triangles) const {
    triangles.emplace_back(corners_[previous_[i]].number, corners_[i].number, corners_[next_[i]].number);
  }

  std::optional<uint32_t> findEar(uint32_t first, size_t left) {
    for (const Demand& demand : kDemands) {
      uint32_t i = first;
      for (size_t k = 0; k < left; ++k, i = next_[i])
        if (isConvex_[i] && isEar(i, demand)) return i;
    }
    return {};
  }

  bool isEar(uint32_t i, const Demand& demand) {
    const uint32_t before = previous_[i], after = next_[i];
    const glm::dvec2 &a = position(before), &b = position(i), &c = position(after);
    const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    if (doubleArea(a, b, c) <= demand.height * longest * longest) return false;
    if (!isInsideAt(before, c) || !isInsideAt(after, a)) return false;
    const double gap = demand.gap * longest;
    const auto isIn = [&](const glm::dvec2& p, const glm::dvec2& from, const glm::dvec2& to) {
      return doubleArea(from, to, p) >= -gap * glm::distance(from, to);
    };
    for (uint32_t k = next_[after]; k != before; k = next_[k]) {
      if (++steps_ > kMostEarSteps) return false;
      const glm::dvec2& p = position(k);
      if (!isConvex_[k] && p != a && p != b && p != c && isIn(p, a, b) && isIn(p, b, c) && isIn(p, c, a))
        return false;
    }
    return true;
  }

  /// Returns whether the way from a corner to a point begins inside the polygon, or along an edge.
  bool isInsideAt(uint32_t i, const glm::dvec2& p) const {
    const glm::dvec2 &before = position(previous_[i]), &at = position(i), &after = position(next_[i]);
    const bool leftOfFirst = doubleArea(before, at, p) >= 0.0, leftOfSecond = doubleArea(at, after, p) >= 0.0;
    return isConvex_[i] ? leftOfFirst && leftOfSecond : leftOfFirst || leftOfSecond;
  }

  std::vector<FlatCorner> corners_;
  std::vector<uint32_t> previous_, next_;
  std::vector<bool> isConvex_;
  size_t steps_ = 0;
};

/// Returns whether the way from a corner of a loop to a point begins inside.
bool beginsInside(std::span<const FlatCorner> loop, size_t i, const glm::dvec2& p) {
  const size_t n = loop.size();
  const glm::dvec2 &before = loop[(i + n - 1) % n].position, &at = loop[i].position,
                   &after = loop[(i + 1) % n].position;
  const bool leftOfFirst = doubleArea(before, at, p) > 0.0, leftOfSecond = doubleArea(at, after, p) > 0.0;
  return doubleArea(before, at, after) > 0.0 ? leftOfFirst && leftOfSecond : leftOfFirst || leftOfSecond;
}

/// Joins a hole to an outline by a bridge from its rightmost corner. Returns false if there is no place.
bool joinHole(std::vector<FlatCorner>& outline, std::vector<FlatCorner> hole,
              std::span<const std::vector<FlatCorner>> loops) {
  const auto rightmost = std::ranges::max_element(
      hole, {}, [](const FlatCorner& corner) { return std::pair(corner.position.x, corner.position.y); });
  std::rotate(hole.begin(), rightmost, hole.end());
  const glm::dvec2& from = hole[0].position;
  std::vector<size_t> order(outline.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, {}, [&](size_t i) { return glm::distance(outline[i].position, from); });
  const auto meets = [&](const glm::dvec2& to, std::span<const FlatCorner> loop) {
    for (size_t i = 0; i < loop.size(); ++i)
      if (doMeet(from, to, loop[i].position, loop[(i + 1) % loop.size()].position)) return true;
    return false;
  };
  const auto isFree = [&](const glm::dvec2& to) {
    return !meets(to, outline) &&
           std::ranges::none_of(loops, [&](const auto& loop) { return meets(to, loop); });
  };
  for (const size_t i : order) {
    if (outline[i].position == from || !beginsInside(outline, i, from) || !isFree(outline[i].position))
      continue;
    hole.push_back(hole[0]);
    hole.push_back(outline[i]);
    outline.insert(outline.begin() + ptrdiff_t(i) + 1, hole.begin(), hole.end());
    return true;
  }
  return false;
}

}  // namespace

bool coverPolygon(std::span<const std::vector<FlatCorner>> loops, std::vector<glm::uvec3>& triangles) {
  size_t corners = 0;
  double area = 0.0;
  for (const std::vector<FlatCorner>& loop : loops) {
    corners += loop.size();
    area += doubleArea(loop);
  }
  if (corners > kMostCorners || corners * loops.size() > kMostBridgeSteps || !(area > 0.0)) return false;
  std::vector<size_t> holes(loops.size() - 1);
  std::iota(holes.begin(), holes.end(), size_t{1});
  const auto rightmost = [&](size_t h) {
    double x = -INFINITY;
    for (const FlatCorner& corner : loops[h]) x = std::max(x, corner.position.x);
    return -x;
  };
  std::ranges::stable_sort(holes, {}, rightmost);
  std::vector<FlatCorner> outline = loops[0];
  for (const size_t h : holes)
    if (!joinHole(outline, loops[h], loops)) return false;
  const size_t before = triangles.size();
  const bool isDone = EarClipper(std::move(outline)).run(triangles);
  if (!isDone) triangles.resize(before);
  return isDone;
}

}  // namespace raymap
