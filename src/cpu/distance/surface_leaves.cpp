// Ours: builds the lowest levels of the tree behind exact_distance, in SIMD lanes.

#include "cpu/distance/surface_leaves.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/distance/surface_leaves.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

/// Vectors, one per lane.
template <class D>
struct Vectors {
  using Value = hn::Vec<D>;
  Value x, y, z;

  /// Returns the same vector in every lane.
  static HWY_INLINE Vectors all(const glm::vec3& v) {
    return {hn::Set(D(), v.x), hn::Set(D(), v.y), hn::Set(D(), v.z)};
  }
  HWY_INLINE Vectors operator+(const Vectors& b) const {
    return {hn::Add(x, b.x), hn::Add(y, b.y), hn::Add(z, b.z)};
  }
  HWY_INLINE Vectors operator-(const Vectors& b) const {
    return {hn::Sub(x, b.x), hn::Sub(y, b.y), hn::Sub(z, b.z)};
  }
  HWY_INLINE Vectors operator*(Value s) const { return {hn::Mul(x, s), hn::Mul(y, s), hn::Mul(z, s)}; }
  HWY_INLINE Vectors min(const Vectors& b) const {
    return {hn::Min(x, b.x), hn::Min(y, b.y), hn::Min(z, b.z)};
  }
  HWY_INLINE Vectors max(const Vectors& b) const {
    return {hn::Max(x, b.x), hn::Max(y, b.y), hn::Max(z, b.z)};
  }
  HWY_INLINE Value dot(const Vectors& b) const {
    return hn::MulAdd(x, b.x, hn::MulAdd(y, b.y, hn::Mul(z, b.z)));
  }
  HWY_INLINE Vectors cross(const Vectors& b) const {
    return {hn::MulSub(y, b.z, hn::Mul(z, b.y)), hn::MulSub(z, b.x, hn::Mul(x, b.z)),
            hn::MulSub(x, b.y, hn::Mul(y, b.x))};
  }
  template <class M>
  static HWY_INLINE Vectors select(M mask, const Vectors& a, const Vectors& b) {
    return {hn::IfThenElse(mask, a.x, b.x), hn::IfThenElse(mask, a.y, b.y), hn::IfThenElse(mask, a.z, b.z)};
  }
};

using DoubleTag = hn::CappedTag<double, kPacket>;
using Double3 = Vectors<DoubleTag>;
using Tag = hn::CappedTag<float, kPacket>;
using Float = hn::Vec<Tag>;
using Float3 = Vectors<Tag>;

/// Loads one corner of as many triangles as there are lanes.
HWY_INLINE Float3 loadFloats(const float (&corner)[3][kPacket], size_t i) {
  return {hn::Load(Tag(), corner[0] + i), hn::Load(Tag(), corner[1] + i), hn::Load(Tag(), corner[2] + i)};
}

using NarrowTag = hn::Rebind<float, DoubleTag>;
HWY_INLINE Double3 loadDoubles(const float (&corner)[3][kPacket], size_t i) {
  const auto axis = [&](int a) { return hn::PromoteTo(DoubleTag(), hn::Load(NarrowTag(), corner[a] + i)); };
  return {axis(0), axis(1), axis(2)};
}
HWY_INLINE void store(Double3::Value value, float* to) {
  hn::Store(hn::DemoteTo(NarrowTag(), value), NarrowTag(), to);
}
HWY_INLINE void store(const Double3& v, float* toX, float* toY, float* toZ) {
  store(v.x, toX), store(v.y, toY), store(v.z, toZ);
}

/// Returns unit vectors across the unit vectors `x` and across `e`. If the cross product is mostly rounding
/// error, it may point along `x`. Then any direction across `x` will do, because `e` lies along `x`.
HWY_INLINE Double3 directionAcross(const Double3& x, const Double3& e) {
  const DoubleTag d;
  const Double3 v = x.cross(e);
  const auto v2 = v.dot(v);
  const auto sound = hn::Gt(v2, hn::Mul(hn::Set(d, 1e-18), e.dot(e)));
  const auto alongX = hn::Lt(hn::Abs(x.x), hn::Set(d, 0.6));
  const auto one = hn::Set(d, 1.0), zero = hn::Zero(d);
  const Double3 other = x.cross({hn::IfThenElse(alongX, one, zero), hn::IfThenElse(alongX, zero, one), zero});
  const Double3 across = Double3::select(sound, v, other);
  return across * hn::Div(one, hn::Sqrt(across.dot(across)));
}

/// Converts triangles to their own frames. The longest edge becomes ab, so that c lies over it and slivers
/// keep a sound frame.
void makeFrames(const CornerPacket& corners, TrianglePacket& out) {
  const DoubleTag d;
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.0);
  const auto inverse = [&](auto square) {
    return hn::IfThenElseZero(hn::Gt(square, hn::Set(d, 1e-30)), hn::Div(one, square));
  };
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const Double3 p = loadDoubles(corners.v[0], i), q = loadDoubles(corners.v[1], i),
                  r = loadDoubles(corners.v[2], i);
    const Double3 pq = q - p, qr = r - q, rp = p - r;
    const auto pq2 = pq.dot(pq), qr2 = qr.dot(qr), rp2 = rp.dot(rp);
    const auto fromQ = hn::And(hn::Ge(qr2, pq2), hn::Ge(qr2, rp2)), fromR = hn::Gt(rp2, hn::Max(pq2, qr2));
    const auto pick = [&](const Double3& ifP, const Double3& ifQ, const Double3& ifR) {
      return Double3::select(fromQ, ifQ, Double3::select(fromR, ifR, ifP));
    };
    const Double3 a = pick(p, q, r), b = pick(q, r, p), c = pick(r, p, q);
    const Double3 ab = b - a, e = c - a;
    const auto length2 = ab.dot(ab), length = hn::Sqrt(length2);
    const auto point = hn::Le(length, zero);
    const Double3 x =
        Double3::select(point, {one, zero, zero}, ab * hn::Div(one, hn::IfThenElse(point, one, length)));
    const Double3 z = directionAcross(x, e), y = z.cross(x);
    const auto cx = e.dot(x), cy = e.dot(y), ex = hn::Sub(cx, length);
    store(a, out.ax + i, out.ay + i, out.az + i);
    store(x, out.xx + i, out.xy + i, out.xz + i);
    store(y, out.yx + i, out.yy + i, out.yz + i);
    store(z, out.zx + i, out.zy + i, out.zz + i);
    store(length, out.bx + i), store(cx, out.cx + i), store(cy, out.cy + i);
    store(inverse(hn::MulAdd(ex, ex, hn::Mul(cy, cy))), out.inverseBc2 + i);
    store(inverse(hn::MulAdd(cx, cx, hn::Mul(cy, cy))), out.inverseCa2 + i);
  }
}

HWY_INLINE float least(Float v) {
  return hn::GetLane(hn::MinOfLanes(Tag(), v));
}
HWY_INLINE float most(Float v) {
  return hn::GetLane(hn::MaxOfLanes(Tag(), v));
}
HWY_INLINE float sum(Float v) {
  return hn::GetLane(hn::SumOfLanes(Tag(), v));
}
HWY_INLINE glm::vec3 least(const Float3& v) {
  return {least(v.x), least(v.y), least(v.z)};
}
HWY_INLINE glm::vec3 most(const Float3& v) {
  return {most(v.x), most(v.y), most(v.z)};
}
HWY_INLINE glm::vec3 sum(const Float3& v) {
  return {sum(v.x), sum(v.y), sum(v.z)};
}

void boundLeaf(const CornerPacket& corners, uint32_t lane, DiscPacket& discs) {
  const Tag d;
  const Float3 nothing{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  Float3 low = Float3::all(glm::vec3(INFINITY)), high = Float3::all(glm::vec3(-INFINITY)), normals = nothing;
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
    const Float3 a = loadFloats(corners.v[0], i), b = loadFloats(corners.v[1], i),
                 c = loadFloats(corners.v[2], i);
    low = low.min(a).min(b).min(c);
    high = high.max(a).max(b).max(c);
    normals = normals + (b - a).cross(c - a);
  }
  const glm::vec3 normalSum = sum(normals);
  const float length = glm::length(normalSum);
  const glm::vec3 normal = length > 1e-12f ? normalSum / length : glm::vec3(0, 0, 1);
  const glm::vec3 middle = 0.5f * (least(low) + most(high));
  const Float3 n = Float3::all(normal), m = Float3::all(middle);
  Float front = hn::Set(d, -INFINITY), back = hn::Set(d, INFINITY), radius2 = hn::Zero(d);
  for (size_t i = 0; i < kPacket; i += hn::Lanes(d))
    for (const auto& corner : corners.v) {
      const Float3 q = loadFloats(corner, i) - m;
      const Float height = q.dot(n);
      front = hn::Max(front, height);
      back = hn::Min(back, height);
      radius2 = hn::Max(radius2, hn::NegMulAdd(height, height, q.dot(q)));
    }
  const float top = most(front), bottom = least(back);
  const glm::vec3 centre = middle + 0.5f * (top + bottom) * normal;
  discs.cx[lane] = centre.x, discs.cy[lane] = centre.y, discs.cz[lane] = centre.z;
  discs.nx[lane] = normal.x, discs.ny[lane] = normal.y, discs.nz[lane] = normal.z;
  discs.radius[lane] = std::sqrt(std::max(most(radius2), 0.0f));
  discs.halfThickness[lane] = 0.5f * (top - bottom);
}

}  // namespace
}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

HWY_EXPORT(makeFrames);
HWY_EXPORT(boundLeaf);

void makeFrames(const CornerPacket& corners, TrianglePacket& triangles) {
  HWY_DYNAMIC_DISPATCH(makeFrames)(corners, triangles);
}

void boundLeaf(const CornerPacket& corners, uint32_t lane, DiscPacket& discs) {
  HWY_DYNAMIC_DISPATCH(boundLeaf)(corners, lane, discs);
}

}  // namespace raymap::cpu
#endif
