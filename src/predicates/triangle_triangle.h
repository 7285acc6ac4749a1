#pragma once

// Two triangles.
//
// Precision: exact, on integers of up to 2^29.
// Ties: none are broken. Triangles that touch, or lie in a common plane, do not cross. Those that only touch
// do not overlap in their plane.

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>

#include "predicates/int128.h"

namespace raymap {

/// Largest coordinate of a corner, as a power of two: determinants fit into 128 bits.
inline constexpr int kTriangleBits = 29;
/// Extent below which the determinants of two triangles that meet fit into 64 bits.
inline constexpr int32_t kSmallExtent = int32_t{1} << 19;

/// Corners of a triangle with whole coordinates.
using WholeTriangle = std::array<glm::ivec3, 3>;

/// Sides of a plane on which the corners of a triangle lie: -1, 0 or 1.
using CornerSides = std::array<int, 3>;

/// Plane of a triangle. The normal's components fit into 63 bits.
class WholePlane {
 public:
  explicit WholePlane(const WholeTriangle& t) : point_(t[0]) {
    const Point u = Point(t[1]) - point_, v = Point(t[2]) - point_;
    normal_ = {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  }

  /// `Wide` must hold the determinants.
  template <class Wide>
  int sideOf(const glm::ivec3& p) const {
    const Point w = Point(p) - point_;
    const Wide value = Wide(normal_.x) * w.x + Wide(normal_.y) * w.y + Wide(normal_.z) * w.z;
    return int(value > 0) - int(value < 0);
  }
  template <class Wide>
  CornerSides sidesOf(const WholeTriangle& t) const {
    return {sideOf<Wide>(t[0]), sideOf<Wide>(t[1]), sideOf<Wide>(t[2])};
  }
  /// `areSmall`: both triangles meet, and their extents are below `kSmallExtent`.
  CornerSides sidesOf(const WholeTriangle& t, bool areSmall) const {
    return areSmall ? sidesOf<int64_t>(t) : sidesOf<Int128>(t);
  }
  /// Returns the axis along which the triangle looks largest, or -1 if it has no area.
  int steepestAxis() const {
    const Point n = glm::abs(normal_);
    if (n == Point(0)) return -1;
    return n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
  }
  const glm::i64vec3& normal() const { return normal_; }

 private:
  using Point = glm::i64vec3;

  Point point_, normal_;
};

/// Axis along which the common line of two planes is longest, and where the cross product of their normals
/// points there: 1 or -1; 0 if they are parallel.
struct CommonLine {
  int axis = 0, sign = 0;
};

inline CommonLine commonLine(const glm::i64vec3& m, const glm::i64vec3& n) {
  CommonLine line;
  Int128 longest = 0;
  for (int k = 0; k < 3; ++k) {
    const int u = (k + 1) % 3, v = (k + 2) % 3;
    const Int128 along = Int128(m[u]) * n[v] - Int128(m[v]) * n[u], length = along < 0 ? -along : along;
    if (length <= longest) continue;
    longest = length;
    line = {k, along > 0 ? 1 : -1};
  }
  return line;
}

inline bool areOnBoth(const CornerSides& sides) {
  return std::min(std::min(sides[0], sides[1]), sides[2]) < 0 &&
         std::max(std::max(sides[0], sides[1]), sides[2]) > 0;
}

/// Returns the side on which one corner is alone.
inline int aloneOn(const CornerSides& sides) {
  return sides[0] + sides[1] + sides[2] > 0 ? -1 : 1;
}

/// Returns the corners in order, starting with the one that is alone on its side.
inline WholeTriangle fromAlone(WholeTriangle t, const CornerSides& sides) {
  const auto alone = std::find(sides.begin(), sides.end(), aloneOn(sides)) - sides.begin();
  std::rotate(t.begin(), t.begin() + alone, t.end());
  return t;
}

/// Returns whether the line from `a` to `b` has no corner of a triangle on its left, seen along an axis.
/// `turn` is -1 if left is right.
inline bool hasNoneOnLeft(const glm::ivec3& a, const glm::ivec3& b, const WholeTriangle& t, int axis,
                          int64_t turn) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const int64_t x = int64_t{b[u]} - a[u], y = int64_t{b[v]} - a[v];
  return std::ranges::all_of(t, [&](const glm::ivec3& p) {
    return turn * (x * (int64_t{p[v]} - a[v]) - y * (int64_t{p[u]} - a[u])) <= 0;
  });
}

/// Returns whether an edge of the first of two triangles in a common plane has the second one beside it.
inline bool isBeside(const WholeTriangle& a, const WholeTriangle& b, int axis) {
  const int64_t turn = hasNoneOnLeft(a[0], a[1], a, axis, 1) ? -1 : 1;
  return hasNoneOnLeft(a[0], a[1], b, axis, turn) || hasNoneOnLeft(a[1], a[2], b, axis, turn) ||
         hasNoneOnLeft(a[2], a[0], b, axis, turn);
}

/// Returns whether inner points of two triangles in a common plane coincide. `b` must have all corners in the
/// plane of `a`.
inline bool overlapInPlane(const WholeTriangle& a, const WholePlane& planeOfA, const WholeTriangle& b) {
  const int axis = planeOfA.steepestAxis();
  if (axis < 0 || WholePlane(b).steepestAxis() < 0) return false;
  return !isBeside(a, b, axis) && !isBeside(b, a, axis);
}

/// How two triangles meet: inner points of both coincide, or none.
enum class Meeting : uint8_t { None, Cross, InPlane };

/// Returns whether inner points of both triangles coincide, except in a common plane. Each must reach through
/// the other's plane, and their intervals on the planes' common line must overlap (Guigue & Devillers 2003).
/// Triangles that share an edge do not reach through each other's planes. `ofB` are the sides of the first
/// one's plane on which the second one's corners lie.
inline bool doCross(const WholeTriangle& a, const CornerSides& ofB, const WholeTriangle& b, bool areSmall) {
  if (!areOnBoth(ofB)) return false;
  const CornerSides ofA = WholePlane(b).sidesOf(a, areSmall);
  if (!areOnBoth(ofA)) return false;
  auto [p, q, r] = fromAlone(a, ofA);
  auto [s, t, u] = fromAlone(b, ofB);
  if (aloneOn(ofA) < 0) std::swap(t, u);
  if (aloneOn(ofB) < 0) std::swap(q, r);
  return WholePlane({p, q, s}).sideOf<Int128>(t) < 0 && WholePlane({p, r, u}).sideOf<Int128>(s) < 0;
}

/// Returns how two triangles meet.
inline Meeting meet(const WholeTriangle& a, const WholePlane& planeOfA, const WholeTriangle& b,
                    bool areSmall) {
  const CornerSides ofB = planeOfA.sidesOf(b, areSmall);
  if (ofB == CornerSides{0, 0, 0}) return overlapInPlane(a, planeOfA, b) ? Meeting::InPlane : Meeting::None;
  return doCross(a, ofB, b, areSmall) ? Meeting::Cross : Meeting::None;
}

inline bool areBeside(const CornerSides& sides) {
  return sides[0] != 0 && sides[0] == sides[1] && sides[0] == sides[2];
}

/// Returns whether two triangles with one common corner have no other point in common, or false if an edge of
/// one lies in the other's plane. From the corner, each reaches along the common line of the planes if its
/// other corners are on both sides of the other's plane; which way follows from the order of these sides.
inline bool meetAtCornerOnly(const WholeTriangle& a, const CornerSides& ofA, const WholeTriangle& b,
                             const CornerSides& ofB) {
  for (size_t i = 0; i < 3; ++i) {
    const auto j = size_t(std::ranges::find(b, a[i]) - b.begin());
    if (j == 3) continue;
    const int q = ofA[(i + 1) % 3], r = ofA[(i + 2) % 3], s = ofB[(j + 1) % 3], t = ofB[(j + 2) % 3];
    return q * r > 0 || s * t > 0 || (q * r < 0 && s * t < 0 && q * s > 0);
  }
  return false;
}

/// Returns how two triangles may meet: as `meet` does, but also if they touch outside of common corners and
/// edges, and in some cases where they do not.
inline Meeting mayTouch(const WholeTriangle& a, const WholePlane& planeOfA, const WholeTriangle& b,
                        bool areSmall) {
  const WholePlane planeOfB(b);
  if (planeOfA.steepestAxis() < 0 || planeOfB.steepestAxis() < 0) return Meeting::None;
  const CornerSides ofB = planeOfA.sidesOf(b, areSmall);
  if (ofB == CornerSides{0, 0, 0}) return overlapInPlane(a, planeOfA, b) ? Meeting::InPlane : Meeting::None;
  if (areBeside(ofB)) return Meeting::None;
  const CornerSides ofA = planeOfB.sidesOf(a, areSmall);
  if (areBeside(ofA)) return Meeting::None;
  const auto common =
      std::ranges::count_if(a, [&](const glm::ivec3& p) { return std::ranges::find(b, p) != b.end(); });
  if (common > 1 || (common == 1 && meetAtCornerOnly(a, ofA, b, ofB))) return Meeting::None;
  return Meeting::Cross;
}

}  // namespace raymap
