// Barill et al. 2018, "Fast winding numbers for soups and clouds", where Krayer & Müller 2019, §3.5, only
// sample.
//
// A distant group of triangles is taken as a dipole with a first correction. A close group is summed triangle
// by triangle (Van Oosterom & Strackee 1983).

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/sign/winding_dipoles.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "cpu/distance/surface_shapes-inl.h"
#include "cpu/sign/winding_dipoles.h"

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu {
namespace HWY_NAMESPACE {
namespace {

using Moments = WindingDipoles::Moments;

/// A look at points before the first: most are so far from the threshold that it is enough. The error was at
/// most 0.4 times the estimate.
constexpr float kRoughlyDistant = 1.4f, kLeastRoughError = 0.1f;

constexpr float kHalfOfAll = 2.0f * std::numbers::pi_v<float>;  ///< Half the solid angle of all directions.

/// Returns half the solid angle of each triangle of a packet, seen from p. It is zero in a triangle's plane.
HWY_INLINE Float halfSolidAngle(const Triangle<Each>& t, const glm::vec3& p) {
  const Tag d;
  const Local q = toLocal(t, hn::Set(d, p.x), hn::Set(d, p.y), hn::Set(d, p.z));
  const Float bx = t.read(t.p.bx), cx = t.read(t.p.cx), cy = t.read(t.p.cy), zero = hn::Zero(d);
  const Float au = hn::Neg(q.u), av = hn::Neg(q.v), bu = hn::Sub(bx, q.u), cu = hn::Sub(cx, q.u),
              cv = hn::Sub(cy, q.v), h2 = hn::Mul(q.w, q.w);
  const auto dot = [&](Float u, Float v, Float otherU, Float otherV) {
    return hn::MulAdd(u, otherU, hn::MulAdd(v, otherV, h2));
  };
  const Float a = hn::Sqrt(dot(au, av, au, av)), b = hn::Sqrt(dot(bu, av, bu, av)),
              c = hn::Sqrt(dot(cu, cv, cu, cv));
  const Float volume = hn::Mul(hn::Neg(q.w), hn::Mul(bx, cy));
  const Float denominator =
      hn::MulAdd(hn::Mul(a, b), c,
                 hn::MulAdd(dot(au, av, bu, av), c,
                            hn::MulAdd(dot(bu, av, cu, cv), a, hn::Mul(dot(cu, cv, au, av), b))));
  const Float angle = hn::Atan(d, hn::Div(volume, denominator));
  const Float turn = hn::CopySign(hn::Set(d, std::numbers::pi_v<float>), volume);
  const Float full = hn::Add(angle, hn::IfThenElseZero(hn::Lt(denominator, zero), turn));
  return hn::IfThenElseZero(hn::Ne(volume, zero), full);
}

/// Returns the lanes from `i` on whose index is below `count`.
HWY_INLINE Mask below(size_t i, uint32_t count) {
  const hn::RebindToSigned<Tag> d;
  return hn::RebindMask(
      Tag(), hn::Lt(hn::Iota(d, static_cast<int32_t>(i)), hn::Set(d, static_cast<int32_t>(count))));
}

class DipoleSums {
 public:
  explicit DipoleSums(const glm::vec3& centre) : centre_(centre) {}

  void addTriangles(const TrianglePacket& packet, uint32_t count) {
    const Tag d;
    const Float third = hn::Set(d, 1.0f / 3.0f);
    for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
      const Triangle<Each> t{packet, {i}};
      const Float bx = t.read(packet.bx), cy = t.read(packet.cy);
      const Float area = hn::IfThenElseZero(below(i, count), hn::Mul(hn::Set(d, 0.5f), hn::Mul(bx, cy)));
      const Float u = hn::Mul(hn::Add(bx, t.read(packet.cx)), third), v = hn::Mul(cy, third);
      const auto offset = [&](const float* a, const float* x, const float* y, float centre) {
        return hn::MulAdd(u, t.read(x), hn::MulAdd(v, t.read(y), hn::Sub(t.read(a), hn::Set(d, centre))));
      };
      add(hn::Mul(area, t.read(packet.zx)), hn::Mul(area, t.read(packet.zy)),
          hn::Mul(area, t.read(packet.zz)), offset(packet.ax, packet.xx, packet.yx, centre_.x),
          offset(packet.ay, packet.xy, packet.yy, centre_.y),
          offset(packet.az, packet.xz, packet.yz, centre_.z));
    }
  }

  /// Adds the first `count` nodes of a packet of the level below.
  void addNodes(const Moments& moments, const DiscPacket& discs, uint32_t count) {
    const Tag d;
    for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
      const Each read{i};
      const Mask held = below(i, count);
      const auto part = [&](const float* field) { return hn::IfThenElseZero(held, read(field)); };
      const auto offset = [&](const float* c, float centre) {
        return hn::IfThenElseZero(held, hn::Sub(read(c), hn::Set(d, centre)));
      };
      add(part(moments.nx), part(moments.ny), part(moments.nz), offset(discs.cx, centre_.x),
          offset(discs.cy, centre_.y), offset(discs.cz, centre_.z));
      xx_ = hn::Add(xx_, part(moments.xx)), yy_ = hn::Add(yy_, part(moments.yy)),
      zz_ = hn::Add(zz_, part(moments.zz)), xy_ = hn::Add(xy_, part(moments.xy)),
      yz_ = hn::Add(yz_, part(moments.yz)), zx_ = hn::Add(zx_, part(moments.zx));
    }
  }

  void write(Moments& to, uint32_t lane) const {
    const auto sum = [](Float v) { return hn::GetLane(hn::SumOfLanes(Tag(), v)); };
    to.nx[lane] = sum(nx_), to.ny[lane] = sum(ny_), to.nz[lane] = sum(nz_);
    to.xx[lane] = sum(xx_), to.yy[lane] = sum(yy_), to.zz[lane] = sum(zz_);
    to.xy[lane] = sum(xy_), to.yz[lane] = sum(yz_), to.zx[lane] = sum(zx_);
  }

 private:
  void add(Float nx, Float ny, Float nz, Float x, Float y, Float z) {
    nx_ = hn::Add(nx_, nx), ny_ = hn::Add(ny_, ny), nz_ = hn::Add(nz_, nz);
    const Float half = hn::Set(Tag(), 0.5f);
    xx_ = hn::MulAdd(nx, x, xx_), yy_ = hn::MulAdd(ny, y, yy_), zz_ = hn::MulAdd(nz, z, zz_);
    xy_ = hn::MulAdd(half, hn::MulAdd(nx, y, hn::Mul(ny, x)), xy_);
    yz_ = hn::MulAdd(half, hn::MulAdd(ny, z, hn::Mul(nz, y)), yz_);
    zx_ = hn::MulAdd(half, hn::MulAdd(nz, x, hn::Mul(nx, z)), zx_);
  }

  glm::vec3 centre_;
  Float nx_ = hn::Zero(Tag()), ny_ = nx_, nz_ = nx_;
  Float xx_ = nx_, yy_ = nx_, zz_ = nx_, xy_ = nx_, yz_ = nx_, zx_ = nx_;
};

/// Sums the tree's solid angles at one point after another. Each thread has its own instance.
class SolidAngles {
 public:
  SolidAngles(const SurfaceTree& tree, const Moments* moments) : tree_(tree), moments_(moments) {}

  /// Returns the winding number of the triangles around p. Groups are distant from `distant` radii on.
  float windingNumber(const glm::vec3& p, float distant) {
    distant2_ = distant * distant;
    sum_ = squaredErrors_ = hn::Zero(Tag());
    stack_.push_back(tree_.root() / kPacket);
    while (!stack_.empty()) {
      const uint32_t packet = stack_.back();
      stack_.pop_back();
      forEachLane(addDistant(packet, p), [&](size_t lane) { open(packet * kPacket + uint32_t(lane), p); });
    }
    return hn::GetLane(hn::SumOfLanes(Tag(), sum_)) / kHalfOfAll;
  }

  /// Returns how far the last number may be wrong.
  float error() const {
    return kErrorOfDipoles / kHalfOfAll * std::sqrt(hn::GetLane(hn::SumOfLanes(Tag(), squaredErrors_)));
  }

 private:
  void addLeaf(uint32_t leaf, const glm::vec3& p) {
    const uint32_t count = tree_.triangleCount() - leaf * kPacket;
    const TrianglePacket& triangles = tree_.triangles(leaf);
    for (size_t i = 0; i < kPacket; i += hn::Lanes(Tag())) {
      const Float angle = halfSolidAngle({triangles, {i}}, p);
      sum_ = hn::Add(sum_, hn::IfThenElseZero(below(i, count), angle));
    }
  }

  void open(uint32_t node, const glm::vec3& p) {
    if (tree_.isLeaf(node))
      addLeaf(node, p);
    else
      stack_.push_back(tree_.childPacket(node));
  }

  /// Adds the distant nodes of a packet; returns the lanes of the others.
  uint32_t addDistant(uint32_t packet, const glm::vec3& p) {
    const Tag d;
    const DiscPacket& discs = tree_.discs(packet);
    const Moments& m = moments_[packet];
    uint32_t close = 0;
    for (size_t i = 0; i < kPacket; i += hn::Lanes(d)) {
      const Each read{i};
      const Float x = hn::Sub(read(discs.cx), hn::Set(d, p.x)), y = hn::Sub(read(discs.cy), hn::Set(d, p.y)),
                  z = hn::Sub(read(discs.cz), hn::Set(d, p.z));
      const Float radius = read(discs.radius), thickness = read(discs.halfThickness);
      const Float reach2 = hn::MulAdd(radius, radius, hn::Mul(thickness, thickness));
      const Float r2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
      const Mask distant = hn::Gt(r2, hn::Mul(hn::Set(d, distant2_), reach2));
      const Float inverse = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(r2)), inverse2 = hn::Mul(inverse, inverse);
      const Float flux = hn::MulAdd(x, read(m.nx), hn::MulAdd(y, read(m.ny), hn::Mul(z, read(m.nz))));
      const Float trace = hn::Add(hn::Add(read(m.xx), read(m.yy)), read(m.zz));
      const Float squares =
          hn::MulAdd(hn::Mul(x, x), read(m.xx),
                     hn::MulAdd(hn::Mul(y, y), read(m.yy), hn::Mul(hn::Mul(z, z), read(m.zz))));
      const Float products =
          hn::MulAdd(hn::Mul(x, y), read(m.xy),
                     hn::MulAdd(hn::Mul(y, z), read(m.yz), hn::Mul(hn::Mul(z, x), read(m.zx))));
      const Float second = hn::MulAdd(hn::Set(d, 2.0f), products, squares);
      const Float bracket = hn::NegMulAdd(hn::Mul(hn::Set(d, 3.0f), second), inverse2, hn::Add(flux, trace));
      const Float half = hn::Mul(hn::Mul(hn::Set(d, 0.5f), bracket), hn::Mul(inverse2, inverse));
      sum_ = hn::Add(sum_, hn::IfThenElseZero(distant, half));
      const Float error = hn::IfThenElseZero(distant, hn::Mul(half, hn::Mul(reach2, inverse2)));
      squaredErrors_ = hn::MulAdd(error, error, squaredErrors_);
      close |= bits(hn::Not(distant)) << i;
    }
    return close;
  }

  const SurfaceTree& tree_;
  const Moments* moments_;
  float distant2_ = 0.0f;
  Float sum_, squaredErrors_;
  std::vector<uint32_t> stack_;  // packets of nodes
};

glm::vec3 discCentre(const DiscPacket& discs, uint32_t lane) {
  return {discs.cx[lane], discs.cy[lane], discs.cz[lane]};
}

/// Computes the moments of a level's nodes, from their triangles or from the nodes of the level below.
void buildMoments(const SurfaceTree& tree, size_t level, Moments* moments) {
  constexpr size_t kGrain = 64;
  const SurfaceTree::Level nodes = tree.levels()[level];
  const uint32_t below = level == 0 ? tree.triangleCount() : tree.levels()[level - 1].count;
  parallelFor((nodes.count + kPacket - 1) / kPacket, kGrain, [&](size_t begin, size_t end) {
    for (size_t n = begin * kPacket; n < end * kPacket; ++n) {
      const auto node = static_cast<uint32_t>(nodes.start + n);
      const uint32_t packet = node / kPacket, lane = node % kPacket;
      DipoleSums sums(discCentre(tree.discs(packet), lane));
      if (n < nodes.count) {
        const uint32_t children = tree.childPacket(node), count = below - static_cast<uint32_t>(n) * kPacket;
        if (level == 0)
          sums.addTriangles(tree.triangles(children), count);
        else
          sums.addNodes(moments[children], tree.discs(children), count);
      }
      sums.write(moments[packet], lane);
    }
  });
}

/// Computes the winding numbers at points. The mean error is 0.00001, so that all backends give the same.
void look(const SurfaceTree& tree, const Moments* moments, std::span<const glm::vec3> points,
          float* winding) {
  SolidAngles solidAngles(tree, moments);
  for (size_t p = 0; p < points.size(); ++p) winding[p] = solidAngles.windingNumber(points[p], kDistant[2]);
}

struct Settled {
  float winding;
  bool isSure;
};

/// Returns whether a number is farther from the threshold than it may be wrong.
bool isSure(float winding, float threshold, float error) {
  return std::abs(std::abs(winding) - threshold) >= error;
}

/// Looks ever closer while the number is close to the threshold.
Settled settle(SolidAngles& solidAngles, const glm::vec3& p, float threshold, WindingDipoles::Looks looks) {
  Settled result{.winding = 0.0f, .isSure = false};
  for (uint32_t look = looks.first; look < looks.end && !result.isSure; ++look) {
    result.winding = solidAngles.windingNumber(p, kDistant[look]);
    result.isSure = isSure(result.winding, threshold, std::max(kClose[look], solidAngles.error()));
  }
  return result;
}

/// Appends the samples that are not sure to `unsure`.
void replace(const SurfaceTree& tree, const Moments* moments, const glm::ivec3& dims, float threshold,
             WindingDipoles::Looks looks, std::span<const uint32_t> samples, float* winding,
             std::vector<uint32_t>& unsure) {
  SolidAngles solidAngles(tree, moments);
  const glm::uvec3 d(dims);
  for (const uint32_t s : samples) {
    const Settled settled =
        settle(solidAngles, glm::vec3(s % d.x, s / d.x % d.y, s / d.x / d.y), threshold, looks);
    winding[s] = settled.winding;
    if (!settled.isSure) unsure.push_back(s);
  }
}

void settlePoints(const SurfaceTree& tree, const Moments* moments, std::span<const glm::vec3> points,
                  float threshold, WindingDipoles::Looks looks, float* winding) {
  SolidAngles solidAngles(tree, moments);
  for (size_t p = 0; p < points.size(); ++p) {
    if (looks.first == 0) {
      winding[p] = solidAngles.windingNumber(points[p], kRoughlyDistant);
      if (isSure(winding[p], threshold, std::max(kLeastRoughError, solidAngles.error()))) continue;
    }
    winding[p] = settle(solidAngles, points[p], threshold, looks).winding;
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace raymap::cpu
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

namespace {

HWY_EXPORT(buildMoments);
HWY_EXPORT(look);
HWY_EXPORT(replace);
HWY_EXPORT(settlePoints);

}  // namespace

void WindingDipoles::prepare(const SurfaceTree& tree) {
  moments_.resizeUninitialized(tree.root() / kPacket + 1);
  for (size_t level = 0; level < tree.levels().size(); ++level)
    HWY_DYNAMIC_DISPATCH(buildMoments)(tree, level, moments_.data());
}

void WindingDipoles::settleAt(const SurfaceTree& tree, std::span<const glm::vec3> points, double threshold,
                              Looks looks, std::span<float> winding) const {
  HWY_DYNAMIC_DISPATCH(settlePoints)
  (tree, moments_.data(), points, static_cast<float>(threshold), looks, winding.data());
}

std::vector<float> WindingDipoles::numbersAt(const SurfaceSource& surface, std::span<const glm::vec3> points,
                                             Progress& progress) {
  constexpr size_t kGrain = 256;
  std::vector<float> winding(points.size());
  const SurfaceTree& tree = surface();
  prepare(tree);
  parallelFor(points.size(), kGrain, [&](size_t begin, size_t end) {
    progress.poll();
    HWY_DYNAMIC_DISPATCH(look)
    (tree, moments_.data(), points.subspan(begin, end - begin), winding.data() + begin);
  });
  return winding;
}

std::vector<uint32_t> WindingDipoles::settle(const SurfaceTree& tree, const glm::ivec3& dims,
                                             std::span<const uint32_t> samples, double threshold, Looks looks,
                                             Progress& progress, Buffer<float>& winding) {
  constexpr size_t kGrain = 64;
  prepare(tree);
  std::vector<std::vector<uint32_t>> unsure((samples.size() + kGrain - 1) / kGrain);
  parallelFor(unsure.size(), 1, [&](size_t part, size_t) {
    progress.poll();
    const size_t begin = part * kGrain, count = std::min(kGrain, samples.size() - begin);
    HWY_DYNAMIC_DISPATCH(replace)
    (tree, moments_.data(), dims, static_cast<float>(threshold), looks, samples.subspan(begin, count),
     winding.data(), unsure[part]);
  });
  return joined(unsure);
}

}  // namespace raymap::cpu
#endif
