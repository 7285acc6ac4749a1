// Exact distance in double precision. Several points are measured at once, with every instruction set to the
// same bits.

#include "cpu/points/closest_point.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/points/closest_point.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include <raymap/field.h>

#include <algorithm>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kLanes = 8;  // At most.

/// Triangles whose squared sine at a corner is below this are slivers. Their normals may be rounding errors.
constexpr double kSliver = 1e-16;

/// One vector per lane of `D`.
template <class D>
struct Vectors {
  using Double = hn::Vec<D>;
  Double x, y, z;

  HWY_INLINE Vectors operator+(const Vectors& v) const {
    return {hn::Add(x, v.x), hn::Add(y, v.y), hn::Add(z, v.z)};
  }
  HWY_INLINE Vectors operator-(const Vectors& v) const {
    return {hn::Sub(x, v.x), hn::Sub(y, v.y), hn::Sub(z, v.z)};
  }
  HWY_INLINE Vectors operator*(Double s) const { return {hn::Mul(x, s), hn::Mul(y, s), hn::Mul(z, s)}; }
};

template <class D>
HWY_INLINE hn::Vec<D> dot(const Vectors<D>& a, const Vectors<D>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

template <class D>
HWY_INLINE Vectors<D> cross(const Vectors<D>& a, const Vectors<D>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}

/// Points of triangles, and their squared distances.
template <class D>
struct Closest {
  Vectors<D> position, weights;
  hn::Vec<D> squared;

  HWY_INLINE void takeWhere(hn::Mask<D> mask, const Closest& other) {
    const auto choose = [&](hn::Vec<D>& mine, hn::Vec<D> its) { mine = hn::IfThenElse(mask, its, mine); };
    choose(position.x, other.position.x), choose(position.y, other.position.y);
    choose(position.z, other.position.z), choose(weights.x, other.weights.x);
    choose(weights.y, other.weights.y), choose(weights.z, other.weights.z);
    choose(squared, other.squared);
  }
};

/// Triangles a, b, c and a point p for each.
template <class D>
struct Triangles {
  using Double = hn::Vec<D>;
  Vectors<D> p, a, b, c;

  /// Returns where on the segment from s to e the point closest to p lies, 0 at s and 1 at e.
  HWY_INLINE Double placeOnSegment(const Vectors<D>& s, const Vectors<D>& e) const {
    const Double zero = hn::Zero(D()), one = hn::Set(D(), 1.0);
    const Vectors<D> along = e - s;
    const Double length2 = dot(along, along), place = hn::Div(dot(p - s, along), length2);
    const Double least = hn::IfThenElse(hn::Lt(place, zero), zero, place);
    return hn::IfThenElseZero(hn::Gt(length2, zero), hn::IfThenElse(hn::Lt(one, least), one, least));
  }

  HWY_INLINE Double squaredDistance(const Vectors<D>& q) const { return dot(q - p, q - p); }

  HWY_INLINE Closest<D> onEdges() const {
    const Double ab = placeOnSegment(a, b), bc = placeOnSegment(b, c), ca = placeOnSegment(c, a);
    const Double zero = hn::Zero(D()), one = hn::Set(D(), 1.0);
    const auto pointAt = [&](const Vectors<D>& s, const Vectors<D>& e, Double place,
                             const Vectors<D>& weights) {
      const Vectors<D> position = s + (e - s) * place;
      return Closest<D>{position, weights, squaredDistance(position)};
    };
    Closest<D> best = pointAt(a, b, ab, {hn::Sub(one, ab), ab, zero});
    for (const Closest<D>& other :
         {pointAt(b, c, bc, {zero, hn::Sub(one, bc), bc}), pointAt(c, a, ca, {ca, zero, hn::Sub(one, ca)})})
      best.takeWhere(hn::Lt(other.squared, best.squared), other);
    return best;
  }

  HWY_INLINE Closest<D> closest() const {
    const Double zero = hn::Zero(D());
    const Vectors<D> ab = b - a, ac = c - a, ap = p - a, normal = cross(ab, ac);
    const Double area2 = dot(normal, normal);
    // Weights of b and c at the projection of p, times area2.
    const Double wb = dot(cross(ap, ac), normal), wc = dot(cross(ab, ap), normal);
    const Double v = hn::Div(wb, area2), w = hn::Div(wc, area2);
    const Vectors<D> position = a + ab * v + ac * w;
    Closest<D> inside{position, {hn::Sub(hn::Sub(hn::Set(D(), 1.0), v), w), v, w}, squaredDistance(position)};
    const auto isInside = hn::And(hn::And(hn::Gt(area2, zero), hn::Le(hn::Add(wb, wc), area2)),
                                  hn::And(hn::Ge(wb, zero), hn::Ge(wc, zero)));
    const Double sliver = hn::Mul(hn::Mul(hn::Set(D(), kSliver), dot(ab, ab)), dot(ac, ac));
    const auto isSure = hn::And(isInside, hn::Gt(area2, sliver));
    if (hn::AllTrue(D(), isSure)) return inside;
    const Closest<D> edge = onEdges();
    const auto isInsideCloser = hn::And(isInside, hn::Lt(inside.squared, edge.squared));
    inside.takeWhere(hn::Not(hn::Or(isSure, isInsideCloser)), edge);
    return inside;
  }
};

TrianglePoint findOne(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  using D = hn::CappedTag<double, 1>;
  const auto set = [](const glm::dvec3& v) {
    return Vectors<D>{hn::Set(D(), v.x), hn::Set(D(), v.y), hn::Set(D(), v.z)};
  };
  const auto get = [](const Vectors<D>& v) {
    return glm::dvec3(hn::GetLane(v.x), hn::GetLane(v.y), hn::GetLane(v.z));
  };
  const Closest<D> closest = Triangles<D>{set(p), set(a), set(b), set(c)}.closest();
  return {get(closest.position), get(closest.weights)};
}

void findAll(const PackedMesh& mesh, std::span<const glm::dvec3> points, std::span<const uint32_t> triangles,
             std::span<TrianglePoint> closest) {
  using D = hn::CappedTag<double, kLanes>;
  const size_t lanes = hn::Lanes(D());
  alignas(64) double values[12][kLanes] = {};
  const auto put = [&](size_t vector, size_t lane, const glm::dvec3& v) {
    for (size_t axis = 0; axis < 3; ++axis) values[3 * vector + axis][lane] = v[int(axis)];
  };
  const auto load = [&](size_t vector) {
    return Vectors<D>{hn::Load(D(), values[3 * vector]), hn::Load(D(), values[3 * vector + 1]),
                      hn::Load(D(), values[3 * vector + 2])};
  };
  const auto store = [&](size_t vector, const Vectors<D>& v) {
    hn::Store(v.x, D(), values[3 * vector]);
    hn::Store(v.y, D(), values[3 * vector + 1]);
    hn::Store(v.z, D(), values[3 * vector + 2]);
  };
  const auto get = [&](size_t vector, size_t lane) {
    return glm::dvec3(values[3 * vector][lane], values[3 * vector + 1][lane], values[3 * vector + 2][lane]);
  };
  for (size_t first = 0; first < points.size(); first += lanes) {
    const size_t count = std::min(lanes, points.size() - first);
    for (size_t lane = 0; lane < count; ++lane) {
      put(0, lane, points[first + lane]);
      if (triangles[first + lane] == kNoTriangle) continue;
      const glm::uvec3& face = mesh.triangles[triangles[first + lane]];
      for (int corner = 0; corner < 3; ++corner)
        put(1 + size_t(corner), lane, glm::dvec3(mesh.vertices[face[corner]]));
    }
    const Closest<D> found = Triangles<D>{load(0), load(1), load(2), load(3)}.closest();
    store(0, found.position);
    store(1, found.weights);
    for (size_t lane = 0; lane < count; ++lane) {
      closest[first + lane] = {get(0, lane), get(1, lane)};
      if (triangles[first + lane] == kNoTriangle)
        closest[first + lane].position = closest[first + lane].weights =
            glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    }
  }
}

}  // namespace
}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

HWY_EXPORT(findOne);
HWY_EXPORT(findAll);

TrianglePoint closestPoint(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                           const glm::dvec3& c) {
  return HWY_DYNAMIC_DISPATCH(findOne)(p, a, b, c);
}

void findClosestPoints(const PackedMesh& mesh, std::span<const glm::dvec3> points,
                       std::span<const uint32_t> triangles, std::span<TrianglePoint> closest) {
  HWY_DYNAMIC_DISPATCH(findAll)(mesh, points, triangles, closest);
}

}  // namespace raymap::cpu
#endif
