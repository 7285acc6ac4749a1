// Martens, Trettner & Bessmeltsev 2026, "The Antipodal Method", where Krayer & Müller 2019, §3.5, only
// sample.
//
// A surface and the strips from its rims to infinity, opposite to the ray, close each other. The ray does not
// meet the strips. So the closed surface's number is the ray's crossings, and the strips' share is left to
// subtract: the solid angles of triangles whose third corner lies at infinity (Van Oosterom & Strackee 1983).
//
// Half a solid angle is the argument of a complex number. The sum of them is that of the product, and the
// turns that it has made.

#include "cpu/sign/winding_rims.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/sign/winding_rims.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "cpu/distance/inverse_root-inl.h"
#include "mesh/position_bits.h"

#ifndef RAYMAP_WINDING_RIMS_ONCE
#define RAYMAP_WINDING_RIMS_ONCE
namespace raymap::cpu {
inline constexpr size_t kMostLanes = 16;
inline constexpr double kMostClearance = RimShare().clearance;
/// Shorter numbers are taken as 1, so that no product leaves the range of its type.
template <class T>
inline constexpr double kShortest = sizeof(T) == sizeof(double) ? 1e-14 : 1e-2;

/// Sums over rims at a ball, from which the change of the winding number follows.
struct RimSums {
  glm::dvec3 slope{0.0};
  double first = 0.0, second = 0.0;  ///< Bounds on the sum of first and second derivatives.
  float nearest = 0.0f;              ///< Distance of the nearest rim from the ball.
};
}  // namespace raymap::cpu
#endif

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// A product of complex numbers by lane, each of a length near 1, and how often it has passed the negative
/// axis.
template <class D>
struct Product {
  hn::Vec<D> re, im, turns;

  HWY_INLINE void multiply(hn::Vec<D> x, hn::Vec<D> y) {
    const D d;
    const hn::Vec<D> zero = hn::Zero(d), one = hn::Set(d, 1);
    const hn::Vec<D> newRe = hn::MulSub(re, x, hn::Mul(im, y)), newIm = hn::MulAdd(re, y, hn::Mul(im, x));
    // Two arguments of the same sign pass it if the sum's sign differs.
    const auto up = hn::And(hn::And(hn::Ge(im, zero), hn::Gt(y, zero)), hn::Lt(newIm, zero));
    const auto down = hn::And(hn::And(hn::Lt(im, zero), hn::Lt(y, zero)), hn::Ge(newIm, zero));
    turns = hn::Sub(hn::Add(turns, hn::IfThenElseZero(up, one)), hn::IfThenElseZero(down, one));
    re = newRe;
    im = newIm;
  }

  HWY_INLINE void normalise() {
    const hn::Vec<D> factor = hn::Div(hn::Set(D(), 1), hn::Add(hn::Abs(re), hn::Abs(im)));
    re = hn::Mul(re, factor);
    im = hn::Mul(im, factor);
  }
};

HWY_INLINE auto load(hn::CappedTag<float, kMostLanes> d, const float* values) {
  return hn::LoadU(d, values);
}

HWY_INLINE auto load(hn::CappedTag<double, kMostLanes> d, const float* values) {
  return hn::PromoteTo(d, hn::LoadU(hn::Rebind<float, decltype(d)>(), values));
}

template <class D>
HWY_INLINE hn::Vec<D> reciprocalRoot(D d, hn::Vec<D> v) {
  const hn::Vec<D> one = hn::Set(d, 1);
  if constexpr (sizeof(hn::TFromD<D>) == sizeof(double)) {
    return hn::Div(one, hn::Sqrt(v));
  } else {  // One step of Newton's method.
    const hn::Vec<D> guess = guessInverseRoot(d, v), half = hn::Set(d, 0.5f);
    const hn::Vec<D> error = hn::NegMulAdd(hn::Mul(v, guess), guess, one);
    return hn::MulAdd(hn::Mul(guess, half), error, guess);
  }
}

/// Unit vectors from a point to vertices of a path.
template <class T>
struct UnitVectors {
  static constexpr size_t kMost = 256;  // They stay in the cache. One more ends the last rim.
  alignas(64) T x[kMost + kMostLanes], y[kMost + kMostLanes], z[kMost + kMostLanes];
  alignas(64) T along[kMost + kMostLanes];  ///< Towards the corner at infinity.
};

template <class T>
RimShare sumRims(const RimPaths& paths, const glm::dvec3& p, const glm::dvec3& direction) {
  const hn::CappedTag<T, kMostLanes> d;
  using V = hn::Vec<decltype(d)>;
  const size_t lanes = hn::Lanes(d), count = paths.isStart.size() - kMostLanes;
  const auto set = [&](double v) { return hn::Set(d, static_cast<T>(v)); };
  const auto dot = [](V ax, V ay, V az, V bx, V by, V bz) {
    return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz)));
  };
  // A point in two parts, as its distances to near vertices must be exact.
  const V px = set(p.x), py = set(p.y), pz = set(p.z);
  const V restX = set(p.x - T(p.x)), restY = set(p.y - T(p.y)), restZ = set(p.z - T(p.z));
  // The corner at infinity lies opposite to the ray.
  const V ux = set(-direction.x), uy = set(-direction.y), uz = set(-direction.z);
  const V one = set(1.0), tiny = hn::Set(d, std::numeric_limits<T>::min());
  constexpr size_t kBetween = 16;  // Of as many factors, none leaves the range.
  Product<decltype(d)> product{one, hn::Zero(d), hn::Zero(d)};
  V clearance = set(kMostClearance);
  UnitVectors<T> units;
  for (size_t begin = 0; begin < count; begin += UnitVectors<T>::kMost) {
    const size_t end = std::min(begin + UnitVectors<T>::kMost, count);
    for (size_t i = begin; i < end + lanes; i += lanes) {
      const V x = hn::Sub(hn::Sub(load(d, &paths.vertices[0][i]), px), restX);
      const V y = hn::Sub(hn::Sub(load(d, &paths.vertices[1][i]), py), restY);
      const V z = hn::Sub(hn::Sub(load(d, &paths.vertices[2][i]), pz), restZ);
      const V factor = reciprocalRoot(d, hn::Max(dot(x, y, z, x, y, z), tiny));
      hn::StoreU(hn::Mul(x, factor), d, units.x + (i - begin));
      hn::StoreU(hn::Mul(y, factor), d, units.y + (i - begin));
      hn::StoreU(hn::Mul(z, factor), d, units.z + (i - begin));
      hn::StoreU(hn::Mul(dot(x, y, z, ux, uy, uz), factor), d, units.along + (i - begin));
    }
    size_t untilNormal = kBetween;
    for (size_t i = 0; i < end - begin; i += lanes) {
      const V ax = hn::LoadU(d, units.x + i), ay = hn::LoadU(d, units.y + i), az = hn::LoadU(d, units.z + i);
      const V bx = hn::LoadU(d, units.x + i + 1), by = hn::LoadU(d, units.y + i + 1),
              bz = hn::LoadU(d, units.z + i + 1);
      const V along = hn::Add(hn::LoadU(d, units.along + i), hn::LoadU(d, units.along + i + 1));
      const V nx = hn::MulSub(ay, bz, hn::Mul(az, by)), ny = hn::MulSub(az, bx, hn::Mul(ax, bz)),
              nz = hn::MulSub(ax, by, hn::Mul(ay, bx));
      const V x = hn::Add(hn::Add(one, dot(ax, ay, az, bx, by, bz)), along), y = dot(nx, ny, nz, ux, uy, uz);
      const auto isRim = hn::Ne(load(d, &paths.isStart[begin + i]), hn::Zero(d));
      // Where the ray meets a rim, the complex number is 0, or real and negative.
      const V clear = hn::Max(x, hn::Abs(y));
      clearance = hn::Min(clearance, hn::IfThenElse(isRim, clear, clearance));
      const auto isSure = hn::And(isRim, hn::Gt(hn::Max(hn::Abs(x), hn::Abs(y)), set(kShortest<T>)));
      product.multiply(hn::IfThenElse(isSure, x, one), hn::IfThenElseZero(isSure, y));
      if (--untilNormal == 0) {
        product.normalise();
        untilNormal = kBetween;
      }
    }
    product.normalise();
  }
  T re[kMostLanes], im[kMostLanes], turns[kMostLanes], least[kMostLanes];
  hn::StoreU(product.re, d, re);
  hn::StoreU(product.im, d, im);
  hn::StoreU(product.turns, d, turns);
  hn::StoreU(clearance, d, least);
  std::complex<double> whole(1.0);
  double sum = 0.0;
  for (size_t lane = 0; lane < lanes; ++lane) {
    const std::complex<double> next = whole * std::complex<double>(re[lane], im[lane]);
    sum += double(turns[lane]);
    if ((whole.imag() < 0.0) == (im[lane] < 0) && (next.imag() < 0.0) != (im[lane] < 0) && im[lane] != 0)
      sum += im[lane] < 0 ? -1.0 : 1.0;
    whole = next;
  }
  sum += std::atan2(whole.imag() + 0.0, whole.real()) / (2.0 * std::numbers::pi);  // -0 becomes +0.
  return {sum, double(*std::min_element(least, least + lanes))};
}

RimShare sumFloats(const RimPaths& paths, const glm::dvec3& p, const glm::dvec3& direction) {
  return sumRims<float>(paths, p, direction);
}

RimShare sumDoubles(const RimPaths& paths, const glm::dvec3& p, const glm::dvec3& direction) {
  return sumRims<double>(paths, p, direction);
}

/// The law of Biot and Savart for each straight rim, without the factor 1 / 4 pi. Bounds hold in the ball.
RimSums sumChanges(const RimPaths& paths, const glm::vec3& centre, float reach) {
  const hn::CappedTag<float, kMostLanes> d;
  using V = hn::Vec<decltype(d)>;
  const size_t lanes = hn::Lanes(d), count = paths.isStart.size() - kMostLanes;
  const V zero = hn::Zero(d), tiny = hn::Set(d, 1e-30f), far = hn::Set(d, std::numeric_limits<float>::max());
  const V cx = hn::Set(d, centre.x), cy = hn::Set(d, centre.y), cz = hn::Set(d, centre.z);
  const V two = hn::Set(d, 2.0f), four = hn::Set(d, 4.0f), pi = hn::Set(d, std::numbers::pi_v<float>);
  const auto dot = [](V ax, V ay, V az, V bx, V by, V bz) {
    return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz)));
  };
  V slopeX = zero, slopeY = zero, slopeZ = zero, first = zero, second = zero, nearest = far;
  for (size_t i = 0; i < count; i += lanes) {
    const auto from = [&](size_t k, int axis, V c) {
      return hn::Sub(hn::LoadU(d, &paths.vertices[axis][k]), c);
    };
    const V ax = from(i, 0, cx), ay = from(i, 1, cy), az = from(i, 2, cz);
    const V bx = from(i + 1, 0, cx), by = from(i + 1, 1, cy), bz = from(i + 1, 2, cz);
    const auto isRim = hn::Ne(hn::LoadU(d, &paths.isStart[i]), zero);
    const V ex = hn::Sub(bx, ax), ey = hn::Sub(by, ay), ez = hn::Sub(bz, az);
    const V nx = hn::MulSub(ay, ez, hn::Mul(az, ey)), ny = hn::MulSub(az, ex, hn::Mul(ax, ez)),
            nz = hn::MulSub(ax, ey, hn::Mul(ay, ex));
    const V a = hn::Sqrt(dot(ax, ay, az, ax, ay, az)), b = hn::Sqrt(dot(bx, by, bz, bx, by, bz));
    // a b + dot, without cancellation.
    const V ab = hn::Mul(a, b), cosine = dot(ax, ay, az, bx, by, bz), n2 = dot(nx, ny, nz, nx, ny, nz);
    const V sum = hn::IfThenElse(hn::Lt(cosine, zero), hn::Div(n2, hn::Max(hn::Sub(ab, cosine), tiny)),
                                 hn::Add(ab, cosine));
    const V factor = hn::IfThenElseZero(isRim, hn::Div(hn::Add(a, b), hn::Max(hn::Mul(ab, sum), tiny)));
    slopeX = hn::MulAdd(nx, factor, slopeX);
    slopeY = hn::MulAdd(ny, factor, slopeY);
    slopeZ = hn::MulAdd(nz, factor, slopeZ);
    const V e2 = dot(ex, ey, ez, ex, ey, ez), length = hn::Sqrt(e2);
    const V along = hn::Div(hn::Neg(dot(ax, ay, az, ex, ey, ez)), hn::Max(e2, tiny));
    const V place = hn::Min(hn::Max(along, zero), hn::Set(d, 1.0f));
    const V qx = hn::MulAdd(place, ex, ax), qy = hn::MulAdd(place, ey, ay), qz = hn::MulAdd(place, ez, az);
    const V toBall = hn::Sub(hn::Sqrt(dot(qx, qy, qz, qx, qy, qz)), hn::Set(d, reach));
    nearest = hn::Min(nearest, hn::IfThenElse(isRim, toBall, far));
    // The second of each is the integral along an infinite line.
    const V over = hn::Div(hn::Set(d, 1.0f), hn::Max(toBall, hn::Set(d, 1e-9f))), over2 = hn::Mul(over, over);
    const V slope = hn::Min(hn::Mul(length, over2), hn::Mul(pi, over));
    const V bend = hn::Min(hn::Mul(two, hn::Mul(length, hn::Mul(over2, over))), hn::Mul(four, over2));
    first = hn::Add(first, hn::IfThenElseZero(isRim, slope));
    second = hn::Add(second, hn::IfThenElseZero(isRim, bend));
  }
  const auto total = [&](V v) { return double(hn::GetLane(hn::SumOfLanes(d, v))); };
  return {{total(slopeX), total(slopeY), total(slopeZ)},
          total(first),
          total(second),
          hn::GetLane(hn::MinOfLanes(d, nearest))};
}

}  // namespace
}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

namespace {

HWY_EXPORT(sumFloats);
HWY_EXPORT(sumDoubles);
HWY_EXPORT(sumChanges);

/// With more rims, their slope costs more than it tells.
constexpr size_t kMostSlopes = 4096;

/// Returns a bound on the error in single precision.
double floatError(size_t rims, double clearance) {
  if (clearance <= double(kShortest<float>)) return std::numeric_limits<double>::max();
  return 1e-7 + 1e-8 * std::sqrt(double(rims)) + 5e-8 / clearance;
}

/// Vertices of paths, and whether a rim begins at each.
struct Path {
  std::vector<glm::vec3> vertices;
  std::vector<bool> isStart;
};

/// Joins rims that begin where another one ends.
Path joinRims(std::span<const RimLine> rims) {
  std::unordered_multimap<uint64_t, size_t> startingAt;
  for (size_t i = rims.size(); i-- > 0;) startingAt.emplace(hashOf(rims[i].from), i);
  std::vector<bool> isTaken(rims.size(), false);
  const auto next = [&](const glm::vec3& p) {
    size_t found = rims.size();
    const auto [begin, end] = startingAt.equal_range(hashOf(p));
    for (auto each = begin; each != end; ++each)
      if (!isTaken[each->second] && rims[each->second].from == p) found = std::min(found, each->second);
    return found;
  };
  Path path;
  for (size_t first = 0; first < rims.size(); ++first) {
    if (isTaken[first]) continue;
    glm::vec3 end;
    for (size_t i = first; i < rims.size(); i = next(end)) {
      isTaken[i] = true;
      path.vertices.push_back(rims[i].from);
      path.isStart.push_back(true);
      end = rims[i].to;
    }
    path.vertices.push_back(end);
    path.isStart.push_back(false);
  }
  return path;
}

}  // namespace

WindingRims::WindingRims(std::span<const RimLine> rims) : count_(rims.size()) {
  if (rims.empty()) return;
  const Path path = joinRims(rims);
  float largest = std::numeric_limits<float>::min();
  for (const glm::vec3& v : path.vertices)
    for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(v[axis]));
  scale_ = std::ldexp(1.0, -std::ilogb(largest));
  const size_t count = path.vertices.size(), filled = (count / kMostLanes + 2) * kMostLanes;
  paths_.isStart.resizeUninitialized(filled);
  for (Buffer<float>& axis : paths_.vertices) axis.resizeUninitialized(filled);
  for (size_t i = 0; i < filled; ++i) {
    for (int axis = 0; axis < 3; ++axis)
      paths_.vertices[axis][i] = float(scale_ * double(path.vertices[std::min(i, count - 1)][axis]));
    paths_.isStart[i] = i < count && path.isStart[i] ? 1.0f : 0.0f;
  }
  if (count_ > kMostSlopes) makeGroups(0, paths_.isStart.size() - 1);
}

RimShare WindingRims::at(const glm::dvec3& point, const glm::dvec3& direction, double allowed) const {
  if (count_ == 0) return {};
  if (allowed > 0.0) {
    const RimShare share = HWY_DYNAMIC_DISPATCH(sumFloats)(paths_, scale_ * point, direction);
    if (floatError(count_, share.clearance) < allowed) return share;
  }
  return HWY_DYNAMIC_DISPATCH(sumDoubles)(paths_, scale_ * point, direction);
}

/// Appends the group of some vertices, and before the next one the groups of its halves.
void WindingRims::makeGroups(size_t begin, size_t end) {
  constexpr size_t kMostOfGroup = 16;
  Group group{begin, end, 0, {}, 0.0f, 0.0f};
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (size_t i = begin; i <= end; ++i) {
    low = glm::min(low, paths_.vertex(i));
    high = glm::max(high, paths_.vertex(i));
    if (i < end && paths_.isStart[i] != 0.0f)
      group.length += glm::distance(paths_.vertex(i), paths_.vertex(i + 1));
  }
  group.centre = 0.5f * (low + high);
  group.radius = 0.5f * glm::distance(low, high);
  if (group.length == 0.0f) return;
  const size_t place = groups_.size();
  groups_.push_back(group);
  if (end - begin > kMostOfGroup) {
    const size_t middle = begin + (end - begin) / 2;
    makeGroups(begin, middle);
    makeGroups(middle, end);
  }
  groups_[place].next = groups_.size();
}

RimChange WindingRims::changeIn(const glm::dvec3& centre, double radius) const {
  constexpr double kRounding = 1.0 + 1e-4, kRoundingOfSlope = 1e-3, kFull = 4.0 * std::numbers::pi;
  constexpr float kNearest = 1e-4f;  // Single precision does not tell the slope so near a rim.
  if (count_ == 0) return {};
  const glm::vec3 c(scale_ * centre);
  const auto reach = float(scale_ * radius * kRounding);
  if (count_ > kMostSlopes) return {{}, kRounding * 2.0 * reach * mostGradient(c, reach) / kFull};
  const RimSums sums = HWY_DYNAMIC_DISPATCH(sumChanges)(paths_, c, reach);
  if (sums.nearest <= 0.0f) return {{}, std::numeric_limits<double>::infinity()};
  const double r = reach, straight = 2.0 * r * sums.first * kRounding;
  const double bend = r * r * sums.second * kRounding + kRoundingOfSlope * straight;
  if (sums.nearest < kNearest || 2.0 * r * glm::length(sums.slope) + bend >= straight)
    return {{}, straight / kFull};
  return {scale_ / kFull * sums.slope, bend / kFull};
}

/// Returns a bound on the gradient in a ball, without the factor 1 / 4 pi.
double WindingRims::mostGradient(const glm::vec3& c, float reach) const {
  constexpr float kRounding = 1.0f + 1e-4f;
  constexpr float kFar = 3.0f;  // Farther than so many times its radius, a group is taken as a whole.
  // A number that may change by a half in the ball tells nothing.
  const float most = std::numbers::pi_v<float> / reach;
  float sum = 0.0f;
  for (size_t g = 0; g < groups_.size() && sum < most;) {
    const Group& group = groups_[g];
    const float near = glm::distance(group.centre, c) - group.radius * kRounding - reach;
    const bool isFar = near > kFar * group.radius, isLeaf = group.next == g + 1;
    if (isFar)
      sum += group.length / (near * near);
    else if (isLeaf)
      sum += gradientOf(group, c, reach);
    g = isFar ? group.next : g + 1;
  }
  return sum < most ? double(sum) : std::numeric_limits<double>::infinity();
}

/// Returns the share of a group's rims one by one, infinite if one of them may meet the ball.
float WindingRims::gradientOf(const Group& group, const glm::vec3& c, float reach) const {
  float sum = 0.0f;
  for (size_t i = group.begin; i < group.end; ++i) {
    if (paths_.isStart[i] == 0.0f) continue;
    const glm::vec3 a = paths_.vertex(i), along = paths_.vertex(i + 1) - a;
    const float length = glm::length(along);
    const float place =
        length > 0.0f ? glm::clamp(glm::dot(c - a, along) / (length * length), 0.0f, 1.0f) : 0.0f;
    const float distance = glm::distance(a + place * along, c) - reach;
    if (distance <= 0.0f) return INFINITY;
    // The second is the integral along an infinite line.
    sum += std::min(length / (distance * distance), std::numbers::pi_v<float> / distance);
  }
  return sum;
}

}  // namespace raymap::cpu
#endif
