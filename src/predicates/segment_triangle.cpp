#include "predicates/segment_triangle.h"

#include <cmath>

namespace raymap {

namespace {

/// Returns the sign of the volume of the parallelepiped of three vectors, or 0 if rounding could change it.
int signOfVolume(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  constexpr double kRounding = 1e-14;
  const double volume = glm::dot(glm::cross(a, b), c);
  const double bound = kRounding * std::sqrt(glm::dot(a, a) * glm::dot(b, b) * glm::dot(c, c));
  if (std::abs(volume) <= bound) return 0;
  return volume > 0.0 ? 1 : -1;
}

}  // namespace

int32_t crossSegment(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& from,
                     const glm::dvec3& to) {
  const glm::dvec3 along = to - from, fa = a - from, fb = b - from, fc = c - from;
  const int ab = signOfVolume(fa, fb, along), bc = signOfVolume(fb, fc, along),
            ca = signOfVolume(fc, fa, along);
  const bool isLeft = ab > 0 || bc > 0 || ca > 0, isRight = ab < 0 || bc < 0 || ca < 0;
  if (isLeft && isRight) return 0;  // The line passes beside the triangle.
  const glm::dvec3 u = b - a, v = c - a;
  const int start = signOfVolume(u, v, from - a), end = signOfVolume(u, v, to - a);
  if (start * end > 0) return 0;
  return ab * bc * ca * start * end == 0 ? kUnsure : start;
}

}  // namespace raymap
