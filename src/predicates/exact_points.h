#pragma once

// Points with rational coordinates, such as those in which edges pass through faces.
//
// Precision: exact. Doubles with a bound on rounding decide most tests, integers of any size the others.
// Ties: none are broken. Points on a line turn by 0.

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <unordered_map>
#include <vector>

namespace raymap {

using Whole =
    boost::multiprecision::number<boost::multiprecision::cpp_int_backend<256>, boost::multiprecision::et_off>;

/// The point `x / w`. `w` is positive.
struct ExactPoint {
  std::array<Whole, 3> x;
  Whole w;

  glm::dvec3 rounded() const;
};

/// Returns where the line from `a` to `b` meets the plane through `point`; `a` and `b` lie on different
/// sides.
ExactPoint crossPlane(const glm::ivec3& a, const glm::ivec3& b, const glm::ivec3& point,
                      const glm::i64vec3& normal);

/// Returns -1, 0 or 1: whether `a` is before `b` along an axis, at the same place, or behind it.
int compareAlong(const ExactPoint& a, const ExactPoint& b, int axis);

/// Distinct points by number: the given ones of a lattice within 2^30, then those that are added.
class ExactPoints {
 public:
  /// The given points must be distinct and ascend.
  explicit ExactPoints(std::vector<glm::ivec3> given);

  size_t size() const { return given_.size() + added_.size(); }
  /// Returns the number of a point. Adds the point if it is new.
  uint32_t numberOf(ExactPoint point);
  /// Returns a triangle that all points lie in, seen along an axis.
  glm::uvec3 frame(int axis) const;

  ExactPoint at(uint32_t point) const;
  /// Returns a point with an error of at most 2^-20.
  const glm::dvec3& rounded(uint32_t point) const { return rounded_[point]; }

  /// Returns -1, 0 or 1 as `compareAlong` does.
  int compare(uint32_t a, uint32_t b, int axis) const;
  /// Returns 1 if the way from `a` over `b` to `c`, seen along an axis, turns counter-clockwise, -1 if
  /// clockwise, and 0 if the three lie on a line.
  int turn(uint32_t a, uint32_t b, uint32_t c, int axis) const;
  /// Returns the side of a plane through `inPlane` on which a point lies: -1, 0 or 1.
  int sideOf(uint32_t point, const glm::ivec3& inPlane, const glm::i64vec3& normal) const;
  /// Returns the number of the point between three others, with whole weights above 0.
  uint32_t between(const glm::uvec3& corners, const glm::ivec3& weights);
  /// Returns the number of the point in a plane where two lines in it cross, of two points each. They must
  /// not be parallel. The plane is seen along an axis along which it does not lie.
  uint32_t crossLines(const std::array<uint32_t, 4>& ends, int axis, const glm::ivec3& inPlane,
                      const glm::i64vec3& normal);

 private:
  std::vector<glm::ivec3> given_;
  std::vector<ExactPoint> added_;
  std::vector<glm::dvec3> rounded_;
  std::unordered_multimap<size_t, uint32_t> places_;  // Of the added ones, by a hash.
};

}  // namespace raymap
