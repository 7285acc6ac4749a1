// Triangles and discs of the surface tree in SIMD lanes. Compiled once per instruction set.

#if defined(RAYMAP_SURFACE_SHAPES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMAP_SURFACE_SHAPES_INL_H
#undef RAYMAP_SURFACE_SHAPES_INL_H
#else
#define RAYMAP_SURFACE_SHAPES_INL_H
#endif

#include <hwy/highway.h>

#include "cpu/distance/inverse_root-inl.h"
#include "cpu/distance/surface_tree.h"

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, kPacket>;
using Float = hn::Vec<Tag>;
using Mask = hn::Mask<Tag>;

constexpr size_t kLanes = kPacket;

/// One value per lane, for any width of the machine's vectors.
struct Lanes {
  alignas(64) float v[kLanes];
  HWY_INLINE Float load(size_t i) const { return hn::Load(Tag(), v + i); }
  HWY_INLINE void store(size_t i, Float x) { hn::Store(x, Tag(), v + i); }
};

HWY_INLINE uint32_t bits(Mask mask) {
  uint8_t out[8] = {};
  hn::StoreMaskBits(Tag(), mask, out);
  return out[0];
}

/// Reads one element of a packet into all lanes.
struct One {
  uint32_t lane;
  HWY_INLINE Float operator()(const float* field) const { return hn::Set(Tag(), field[lane]); }
};
/// Reads each element of a packet into its own lane.
struct Each {
  size_t i;
  HWY_INLINE Float operator()(const float* field) const { return hn::Load(Tag(), field + i); }
};

template <class Read>
struct Triangle {
  const TrianglePacket& p;
  Read read;
};

template <class Read>
struct Disc {
  const DiscPacket& p;
  Read read;
};

/// Point or offset in a triangle's frame.
struct Local {
  Float u, v, w;
};

template <class Read>
HWY_INLINE Local rotate(const Triangle<Read>& t, Float x, Float y, Float z) {
  return {hn::MulAdd(x, t.read(t.p.xx), hn::MulAdd(y, t.read(t.p.xy), hn::Mul(z, t.read(t.p.xz)))),
          hn::MulAdd(x, t.read(t.p.yx), hn::MulAdd(y, t.read(t.p.yy), hn::Mul(z, t.read(t.p.yz)))),
          hn::MulAdd(x, t.read(t.p.zx), hn::MulAdd(y, t.read(t.p.zy), hn::Mul(z, t.read(t.p.zz))))};
}

template <class Read>
HWY_INLINE Local toLocal(const Triangle<Read>& t, Float px, Float py, Float pz) {
  return rotate(t, hn::Sub(px, t.read(t.p.ax)), hn::Sub(py, t.read(t.p.ay)), hn::Sub(pz, t.read(t.p.az)));
}

/// Returns the lesser of the edge functions of bc and ca: distance from the edge times its length, positive
/// inside.
template <class Read>
HWY_INLINE Float insidenessAtC(const Triangle<Read>& t, Float u, Float v, Float ub, Float ex) {
  return hn::Min(hn::MulSub(ex, v, hn::Mul(t.read(t.p.cy), ub)),
                 hn::MulSub(t.read(t.p.cy), u, hn::Mul(t.read(t.p.cx), v)));
}

/// Returns the least of the three edge functions, with that of ab without its length. It is positive if (u,
/// v) lies inside the triangle, and never positive if the triangle has no area.
template <class Read>
HWY_INLINE Float insideness(const Triangle<Read>& t, Float u, Float v, Float ub, Float ex) {
  return hn::Min(v, insidenessAtC(t, u, v, ub, ex));
}

/// Offsets to a point from the closest points of the three edges, in the plane, and their squares. `outside`
/// tells whether the point lies beside the face rather than over it.
struct EdgeOffsets {
  Float abU, abV, ab2, bcU, bcV, bc2, caU, caV, ca2;
  Mask outside;
};

template <class Read>
HWY_INLINE EdgeOffsets edgeOffsets(const Triangle<Read>& t, Float u, Float v) {
  const Tag d;
  const Float zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const Float bx = t.read(t.p.bx), cx = t.read(t.p.cx), cy = t.read(t.p.cy);
  const Float ex = hn::Sub(cx, bx), ub = hn::Sub(u, bx);
  const Float abU = hn::Sub(u, hn::Min(hn::Max(u, zero), bx));
  const Float s =
      hn::Min(hn::Max(hn::Mul(hn::MulAdd(ub, ex, hn::Mul(v, cy)), t.read(t.p.inverseBc2)), zero), one);
  const Float bcU = hn::NegMulAdd(s, ex, ub), bcV = hn::NegMulAdd(s, cy, v);
  const Float r =
      hn::Min(hn::Max(hn::Mul(hn::MulAdd(u, cx, hn::Mul(v, cy)), t.read(t.p.inverseCa2)), zero), one);
  const Float caU = hn::NegMulAdd(r, cx, u), caV = hn::NegMulAdd(r, cy, v);
  return {abU,
          v,
          hn::MulAdd(abU, abU, hn::Mul(v, v)),
          bcU,
          bcV,
          hn::MulAdd(bcU, bcU, hn::Mul(bcV, bcV)),
          caU,
          caV,
          hn::MulAdd(caU, caU, hn::Mul(caV, caV)),
          hn::Le(insideness(t, u, v, ub, ex), zero)};
}

/// Returns the offset to a point from the closest point of the triangle.
template <class Read>
HWY_INLINE Local offsetFrom(const Triangle<Read>& t, const Local& p) {
  const EdgeOffsets e = edgeOffsets(t, p.u, p.v);
  const Mask bcCloser = hn::Lt(e.bc2, e.ab2);
  const Mask caCloser = hn::Lt(e.ca2, hn::Min(e.bc2, e.ab2));
  const Float edgeU = hn::IfThenElse(caCloser, e.caU, hn::IfThenElse(bcCloser, e.bcU, e.abU));
  const Float edgeV = hn::IfThenElse(caCloser, e.caV, hn::IfThenElse(bcCloser, e.bcV, e.abV));
  return {hn::IfThenElseZero(e.outside, edgeU), hn::IfThenElseZero(e.outside, edgeV), p.w};
}

HWY_INLINE Float squared(const Local& o) {
  return hn::MulAdd(o.u, o.u, hn::MulAdd(o.v, o.v, hn::Mul(o.w, o.w)));
}

/// Returns the squared distance alone, which does not depend on which edge is closest.
template <class Read>
HWY_INLINE Float squaredDistance(const Triangle<Read>& t, const Local& p) {
  const EdgeOffsets e = edgeOffsets(t, p.u, p.v);
  const Float edge2 = hn::Min(hn::Min(e.ab2, e.bc2), e.ca2);
  return hn::MulAdd(p.w, p.w, hn::IfThenElseZero(e.outside, edge2));
}

template <class Read>
HWY_INLINE Float squaredDistance(const Triangle<Read>& t, Float px, Float py, Float pz) {
  return squaredDistance(t, toLocal(t, px, py, pz));
}

/// Returns 1 / sqrt(x) to nearly full precision, and much faster. Only pruning uses it, no written result.
HWY_INLINE Float inverseSqrt(Float x) {
  const Tag tag;
  const Float y = guessInverseRoot(tag, x);
  return hn::Mul(y, hn::NegMulAdd(hn::Mul(hn::Mul(x, hn::Set(tag, 0.5f)), y), y, hn::Set(tag, 1.5f)));
}

/// Tangent plane: the distance and its gradient at the lanes' points.
struct Tangent {
  Float d, gx, gy, gz;
};

template <class Read>
HWY_INLINE Tangent tangent(const Triangle<Read>& t, Float px, Float py, Float pz) {
  const Tag tag;
  const Local o = offsetFrom(t, toLocal(t, px, py, pz));
  const Float square = hn::Max(squared(o), hn::Set(tag, 1e-30f));
  const Float inverse = inverseSqrt(square);
  const Float d = hn::Mul(square, inverse);
  const Float u = hn::Mul(o.u, inverse), v = hn::Mul(o.v, inverse), w = hn::Mul(o.w, inverse);
  return {d, hn::MulAdd(u, t.read(t.p.xx), hn::MulAdd(v, t.read(t.p.yx), hn::Mul(w, t.read(t.p.zx)))),
          hn::MulAdd(u, t.read(t.p.xy), hn::MulAdd(v, t.read(t.p.yy), hn::Mul(w, t.read(t.p.zy)))),
          hn::MulAdd(u, t.read(t.p.xz), hn::MulAdd(v, t.read(t.p.yz), hn::Mul(w, t.read(t.p.zz))))};
}

/// Returns the tangent plane of the distance to a disc with thickness. The distance is zero inside the disc.
template <class Read>
HWY_INLINE Tangent tangent(const Disc<Read>& disc, Float px, Float py, Float pz) {
  const Tag tag;
  const Float nx = disc.read(disc.p.nx), ny = disc.read(disc.p.ny), nz = disc.read(disc.p.nz);
  const Float qx = hn::Sub(px, disc.read(disc.p.cx)), qy = hn::Sub(py, disc.read(disc.p.cy)),
              qz = hn::Sub(pz, disc.read(disc.p.cz));
  const Float height = hn::MulAdd(qx, nx, hn::MulAdd(qy, ny, hn::Mul(qz, nz)));
  const Float q2 = hn::MulAdd(qx, qx, hn::MulAdd(qy, qy, hn::Mul(qz, qz)));
  const Float tiny = hn::Set(tag, 1e-30f), zero = hn::Zero(tag);
  const Float rho2 = hn::Max(hn::NegMulAdd(height, height, q2), tiny);
  const Float inverseRho = inverseSqrt(rho2);
  const Float beside = hn::Max(hn::MulSub(rho2, inverseRho, disc.read(disc.p.radius)), zero);
  const Float above = hn::Max(hn::Sub(hn::Abs(height), disc.read(disc.p.halfThickness)), zero);
  const Float square = hn::Max(hn::MulAdd(beside, beside, hn::Mul(above, above)), tiny);
  const Float inverse = inverseSqrt(square);
  const Float d = hn::Mul(square, inverse);
  const Float radial = hn::Mul(hn::Mul(beside, inverse), inverseRho);
  const Float axial = hn::NegMulAdd(radial, height, hn::CopySign(hn::Mul(above, inverse), height));
  return {d, hn::MulAdd(axial, nx, hn::Mul(radial, qx)), hn::MulAdd(axial, ny, hn::Mul(radial, qy)),
          hn::MulAdd(axial, nz, hn::Mul(radial, qz))};
}

/// Returns the squared distance to a disc with thickness.
template <class Read>
HWY_INLINE Float squaredDistance(const Disc<Read>& disc, Float px, Float py, Float pz) {
  const Tag tag;
  const Float qx = hn::Sub(px, disc.read(disc.p.cx)), qy = hn::Sub(py, disc.read(disc.p.cy)),
              qz = hn::Sub(pz, disc.read(disc.p.cz));
  const Float height = hn::MulAdd(qx, disc.read(disc.p.nx),
                                  hn::MulAdd(qy, disc.read(disc.p.ny), hn::Mul(qz, disc.read(disc.p.nz))));
  const Float q2 = hn::MulAdd(qx, qx, hn::MulAdd(qy, qy, hn::Mul(qz, qz)));
  const Float zero = hn::Zero(tag);
  const Float rho = hn::Sqrt(hn::Max(hn::NegMulAdd(height, height, q2), zero));
  const Float beside = hn::Max(hn::Sub(rho, disc.read(disc.p.radius)), zero);
  const Float above = hn::Max(hn::Sub(hn::Abs(height), disc.read(disc.p.halfThickness)), zero);
  return hn::MulAdd(beside, beside, hn::Mul(above, above));
}

/// Calls `visit` with each lane in the set.
template <class Visit>
HWY_INLINE void forEachLane(uint32_t lanes, Visit&& visit) {
  for (; lanes; lanes &= lanes - 1) visit(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
}

}  // namespace HWY_NAMESPACE
}  // namespace raymap::cpu
HWY_AFTER_NAMESPACE();

#endif
