#pragma once

// The origin about which a mesh holds its positions in single precision.

#include <raymap/mesh.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "base/parallel.h"

namespace raymap {

/// Rounds to single precision. Out of line, because GCC 12's vectorizer (SLP) else drops the rounding of some
/// coordinates.
[[gnu::noinline]] inline float roundedToSingle(double value) {
  return float(value);
}

inline glm::vec3 roundedToSingle(const glm::dvec3& p) {
  return {roundedToSingle(p.x), roundedToSingle(p.y), roundedToSingle(p.z)};
}

/// Returns whether single precision about `origin` keeps a coordinate.
inline bool isKeptAbout(double origin, double coordinate) {
  return origin + double(roundedToSingle(coordinate - origin)) == coordinate;
}

/// Returns the middle of an interval, rounded to a multiple of at most 2^-16 of its half. Single precision
/// about it keeps 0, if the interval holds it, and all multiples of 2^-23 of the half.
double roundedMiddle(double low, double high);

/// Which coordinates of an axis single precision keeps. `at(v)` is position v of `count`. Those beyond the
/// box are ignored.
template <class At>
class KeptCoordinates {
 public:
  KeptCoordinates(const Box& box, size_t count, int axis, At& at, double noise)
      : box_(box), count_(count), axis_(axis), at_(at), mostNoise_(noise * (box.max[axis] - box.min[axis])) {}

  bool areAllKept(double origin) const {
    constexpr size_t kBetweenLooks = 256;
    std::atomic<bool> are{true};
    parallelFor(count_, kCheapGrain, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) {
        if (v % kBetweenLooks == 0 && !are) return;
        if (isInBox(v) && !isKept(origin, v)) are = false;
      }
    });
    return are;
  }
  size_t keptCount(double origin) const {
    std::atomic<size_t> sum{0};
    parallelFor(count_, kCheapGrain, [&](size_t begin, size_t end) {
      size_t kept = 0;
      for (size_t v = begin; v < end; ++v) kept += isInBox(v) && isKept(origin, v) ? 1 : 0;
      sum += kept;
    });
    return sum;
  }

 private:
  double coordinate(size_t v) const { return at_(v)[axis_]; }
  bool isInBox(size_t v) const {
    return coordinate(v) >= box_.min[axis_] && coordinate(v) <= box_.max[axis_];
  }
  bool isKept(double origin, size_t v) const {
    return isKeptAbout(origin, coordinate(v)) || isNoise(coordinate(v));
  }
  bool isNoise(double coordinate) const { return coordinate != 0.0 && std::abs(coordinate) <= mostNoise_; }

  const Box& box_;
  size_t count_;
  int axis_;
  At& at_;
  double mostNoise_;
};

/// Numbers this close to 0, in sizes of a mesh, are what programs compute for 0, as for the sine of pi.
/// Corners that such noise takes apart leave slits.
inline constexpr double kNoiseAboutZero = 0x1p-40;

/// Returns the origin about which positions, `at(v)` for all v below `count`, are rounded to single
/// precision. Those beyond the box are ignored.
///
/// Each axis has the first of these that keeps all coordinates, but for those that are not 0 and within
/// `noise` sizes of the box from it: `known`, if it lies in the box, the centre of the box, its
/// `roundedMiddle` and 0. Floats have one that does: about 0 they have at
/// most three times the size that they have about the centre. If none does, it is the `roundedMiddle` if that
/// keeps more coordinates than the centre, else the centre.
template <class At>
glm::dvec3 singleOrigin(const Box& box, size_t count, At&& at, const glm::dvec3* known = nullptr,
                        double noise = 0.0) {
  constexpr bool kAreFloats = std::is_same_v<std::decay_t<decltype(at(size_t{0}))>, glm::vec3>;
  glm::dvec3 origin(0.0);
  for (int axis = 0; axis < 3 && !box.isEmpty(); ++axis) {
    const KeptCoordinates coordinates(box, count, axis, at, noise);
    const double centre = box.centre()[axis], rounded = roundedMiddle(box.min[axis], box.max[axis]);
    double& best = origin[axis];
    const bool isKnownNear = known && (*known)[axis] >= box.min[axis] && (*known)[axis] <= box.max[axis];
    if (isKnownNear && coordinates.areAllKept((*known)[axis]))
      best = (*known)[axis];
    else if (coordinates.areAllKept(centre))
      best = centre;
    else if (coordinates.areAllKept(rounded))
      best = rounded;
    else if (kAreFloats || coordinates.areAllKept(0.0))
      best = 0.0;
    else
      best = coordinates.keptCount(rounded) > coordinates.keptCount(centre) ? rounded : centre;
  }
  return origin;
}

}  // namespace raymap
