#include "field/outside_bound.h"

#include <algorithm>
#include <cmath>

namespace raymap {

namespace {

constexpr double kRounding = 1e-6;  // Of a clamped distance, relative.

/// Returns a length that neither overflows nor is NaN if a coordinate is infinite.
double lengthOf(const glm::dvec3& v) {
  return std::hypot(std::hypot(v.x, v.y), v.z);
}

glm::dvec3 closestIn(const glm::dvec3& low, const glm::dvec3& high, const glm::dvec3& p) {
  return glm::clamp(p, low, high);
}

}  // namespace

OutsideBound::OutsideBound(const Grid& grid, const Box& surfaceBounds, double clampDistance)
    : dims_(grid.dims),
      last_(grid.dims - 1),
      spacing_(grid.spacing),
      lowest_(clampDistance > 0.0 ? -clampDistance / grid.spacing * (1.0 - kRounding) : -INFINITY) {
  if (surfaceBounds.isEmpty()) return;
  surface_.min = (surfaceBounds.min - grid.origin) / grid.spacing;
  surface_.max = (surfaceBounds.max - grid.origin) / grid.spacing;
  isHeld_ = glm::all(glm::greaterThanEqual(surface_.min, glm::dvec3(0.0))) &&
            glm::all(glm::lessThanEqual(surface_.max, last_));
}

bool OutsideBound::isOutside(const glm::dvec3& p) const {
  return glm::any(glm::lessThan(p, glm::dvec3(0.0))) || glm::any(glm::greaterThan(p, last_));
}

/// A distance changes by no more than the way from a sample. Takes the best of the samples around q, the
/// point of the box that is closest to p. NaN if one of them is. The true distance of a sample that is
/// clamped to -band may be anything below, so it bounds nothing.
OutsideBound::Bounds OutsideBound::fromSamples(const glm::dvec3& p, const glm::dvec3& q,
                                               const Read& read) const {
  const glm::ivec3 cell = glm::min(glm::ivec3(q), glm::max(dims_ - 2, 0));
  Bounds best{-INFINITY, -INFINITY};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 sample =
        glm::min(cell + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2), dims_ - 1);
    const double distance = read(sample) / spacing_;
    if (std::isnan(distance)) return {NAN, NAN};
    if (distance <= lowest_) continue;
    best.there = std::max(best.there, distance - lengthOf(p - glm::dvec3(sample)));
    best.atBox = std::max(best.atBox, distance - lengthOf(q - glm::dvec3(sample)));
  }
  return best;
}

double OutsideBound::at(const glm::dvec3& p, const Read& read) const {
  if (glm::any(glm::isnan(p))) return NAN;
  const glm::dvec3 q = closestIn(glm::dvec3(0.0), last_, p);
  const auto [there, atBox] = fromSamples(p, q, read);
  if (std::isnan(there) || surface_.isEmpty()) return there;
  const double toSurface = lengthOf(p - closestIn(surface_.min, surface_.max, p));
  double bound = there;
  if (toSurface > 0.0) bound = std::max(bound, toSurface);
  // Seen from q, the surface in the box is never at an acute angle to p.
  if (isHeld_) bound = std::max(bound, std::hypot(lengthOf(p - q), std::max(atBox, 0.0)));
  return bound;
}

}  // namespace raymap
