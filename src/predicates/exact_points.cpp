#include "predicates/exact_points.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace raymap {

namespace {

constexpr int64_t kFar = int64_t{1} << 32;  // Farther than all points.

int signOf(const Whole& value) {
  return value.sign();
}

/// Makes the denominator positive, and both parts coprime. Euclid's algorithm takes no longer here than the
/// one of Boost, in which clang-tidy finds a shift by all bits.
void reduce(ExactPoint& p) {
  Whole divisor = p.w;
  for (Whole rest : p.x)
    for (; !rest.is_zero(); std::swap(divisor, rest)) divisor %= rest;
  if (p.w.sign() != divisor.sign()) divisor = -divisor;
  if (divisor == 1) return;
  for (Whole& x : p.x) x /= divisor;
  p.w /= divisor;
}

using Line = std::array<Whole, 3>;

/// Returns the cross product: the line through two points of a plane, or the point on two lines.
Line join(const Line& a, const Line& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Line seenAlong(const ExactPoint& p, int axis) {
  return {p.x[size_t(axis + 1) % 3], p.x[size_t(axis + 2) % 3], p.w};
}

bool isBefore(const glm::ivec3& a, const glm::ivec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

}  // namespace

glm::dvec3 ExactPoint::rounded() const {
  const double below = w.convert_to<double>();
  return {x[0].convert_to<double>() / below, x[1].convert_to<double>() / below,
          x[2].convert_to<double>() / below};
}

ExactPoint crossPlane(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& point,
                      const glm::i64vec3& normal) {
  Whole ofA = 0, ofB = 0;
  for (int c = 0; c < 3; ++c) {
    ofA += Whole(normal[c]) * (int64_t{a[c]} - point[c]);
    ofB += Whole(normal[c]) * (int64_t{b[c]} - point[c]);
  }
  ExactPoint p;
  p.w = ofB - ofA;
  for (int c = 0; c < 3; ++c) p.x[size_t(c)] = ofB * a[c] - ofA * b[c];
  if (p.w.sign() < 0) {
    p.w = -p.w;
    for (Whole& x : p.x) x = -x;
  }
  return p;
}

int compareAlong(const ExactPoint& a, const ExactPoint& b, int axis) {
  return signOf(a.x[size_t(axis)] * b.w - b.x[size_t(axis)] * a.w);
}

ExactPoints::ExactPoints(std::vector<glm::ivec3> given) : given_(std::move(given)) {
  rounded_.assign(given_.begin(), given_.end());
  for (int axis = 0; axis < 3; ++axis)
    for (int k = 0; k < 3; ++k) {
      ExactPoint corner{{0, 0, 0}, 1};
      corner.x[size_t(axis + 1) % 3] = k == 1 ? 2 * kFar : -kFar;
      corner.x[size_t(axis + 2) % 3] = k == 2 ? 2 * kFar : -kFar;
      rounded_.push_back(corner.rounded());
      added_.push_back(std::move(corner));
    }
}

glm::uvec3 ExactPoints::frame(int axis) const {
  return glm::uvec3(given_.size() + 3 * size_t(axis)) + glm::uvec3(0, 1, 2);
}

uint32_t ExactPoints::numberOf(ExactPoint p) {
  reduce(p);
  if (p.w == 1) {
    const glm::ivec3 whole(p.x[0].convert_to<int>(), p.x[1].convert_to<int>(), p.x[2].convert_to<int>());
    const auto place = std::ranges::lower_bound(given_, whole, isBefore);
    if (place != given_.end() && *place == whole) return uint32_t(place - given_.begin());
  }
  size_t hash = hash_value(p.w);
  for (const Whole& x : p.x) hash = hash * 0x9e3779b97f4a7c15u + hash_value(x);
  const auto [begin, end] = places_.equal_range(hash);
  for (auto place = begin; place != end; ++place)
    if (const ExactPoint& q = added_[place->second - given_.size()]; q.w == p.w && q.x == p.x)
      return place->second;
  const auto number = uint32_t(size());
  places_.emplace(hash, number);
  rounded_.push_back(p.rounded());
  added_.push_back(std::move(p));
  return number;
}

ExactPoint ExactPoints::at(uint32_t point) const {
  if (point >= given_.size()) return added_[point - given_.size()];
  const glm::ivec3& p = given_[point];
  return {{p.x, p.y, p.z}, 1};
}

int ExactPoints::compare(uint32_t a, uint32_t b, int axis) const {
  if (a == b) return 0;
  constexpr double kRounding = 0x1p-18;
  const double ahead = rounded_[a][axis] - rounded_[b][axis];
  if (std::abs(ahead) > kRounding) return ahead > 0.0 ? 1 : -1;
  return compareAlong(at(a), at(b), axis);
}

int ExactPoints::turn(uint32_t a, uint32_t b, uint32_t c, int axis) const {
  constexpr double kRounding = 0x1p-18;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const glm::dvec3 &from = rounded_[c], p = rounded_[a] - from, q = rounded_[b] - from;
  const double area = p[u] * q[v] - p[v] * q[u];
  const double bound = kRounding * (1.0 + std::abs(p[u]) + std::abs(p[v]) + std::abs(q[u]) + std::abs(q[v])) +
                       0x1p-50 * (std::abs(p[u] * q[v]) + std::abs(p[v] * q[u]));
  if (std::abs(area) > bound) return area > 0.0 ? 1 : -1;
  const Line line = join(seenAlong(at(a), axis), seenAlong(at(b), axis)), third = seenAlong(at(c), axis);
  return signOf(line[0] * third[0] + line[1] * third[1] + line[2] * third[2]);
}

int ExactPoints::sideOf(uint32_t point, const glm::ivec3& inPlane, const glm::i64vec3& normal) const {
  const ExactPoint p = at(point);
  Whole side = 0;
  for (int c = 0; c < 3; ++c) side += (p.x[size_t(c)] - p.w * inPlane[c]) * normal[c];
  return signOf(side);
}

uint32_t ExactPoints::between(const glm::uvec3& corners, const glm::ivec3& weights) {
  const std::array<ExactPoint, 3> p{at(corners.x), at(corners.y), at(corners.z)};
  ExactPoint sum{{0, 0, 0}, p[0].w * p[1].w * p[2].w * (weights.x + weights.y + weights.z)};
  for (size_t k = 0; k < 3; ++k) {
    const Whole weight = p[(k + 1) % 3].w * p[(k + 2) % 3].w * weights[int(k)];
    for (size_t c = 0; c < 3; ++c) sum.x[c] += p[k].x[c] * weight;
  }
  return numberOf(std::move(sum));
}

uint32_t ExactPoints::crossLines(const std::array<uint32_t, 4>& ends, int axis, const glm::ivec3& inPlane,
                                 const glm::i64vec3& normal) {
  const auto lineOf = [&](uint32_t a, uint32_t b) {
    return join(seenAlong(at(a), axis), seenAlong(at(b), axis));
  };
  const auto [x, y, w] = join(lineOf(ends[0], ends[1]), lineOf(ends[2], ends[3]));
  const auto u = size_t(axis + 1) % 3, v = size_t(axis + 2) % 3;
  Whole offset = 0;
  for (int c = 0; c < 3; ++c) offset += Whole(normal[c]) * inPlane[c];
  const Whole steep = normal[axis];
  ExactPoint p;
  p.x[u] = x * steep;
  p.x[v] = y * steep;
  p.x[size_t(axis)] = offset * w - x * normal[int(u)] - y * normal[int(v)];
  p.w = w * steep;
  return numberOf(std::move(p));
}

}  // namespace raymap
