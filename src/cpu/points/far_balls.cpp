#include "cpu/points/far_balls.h"

#include <cmath>

#include "base/parallel.h"
#include "cpu/points/point_query.h"

namespace raymap::cpu {

namespace {

/// Shares of the distance and of the mesh's diagonal by which a ball must be farther than the band, because
/// distances are rounded.
constexpr double kDistanceMargin = 1e-5, kDiagonalMargin = 2e-6;
/// Larger than the error of a query's winding number, up to so many rims and beyond.
constexpr double kErrorOfSomeRims = 1e-5, kErrorOfManyRims = 1e-3;
constexpr size_t kRimsOfSmallError = 4096;

}  // namespace

FarBalls::FarBalls(const PreparedSurface& surface, double radius, double width)
    : surface_(surface),
      radius_(radius),
      far_((radius + width) * (1.0 + kDistanceMargin) +
           kDiagonalMargin * glm::length(bounds(MeshView(surface.mesh)).size())) {}

void FarBalls::find(std::span<const glm::dvec3> centres, Progress& progress, std::span<BallSide> sides) {
  queryPoints(surface_, PointsView(centres), {.maxDistance = far_}, progress, found_);
  for (size_t c = 0; c < centres.size(); ++c) {
    const double distance = found_.distance[c];
    sides[c] = std::abs(distance) < far_ ? BallSide::Near
               : distance < 0.0          ? BallSide::Inside
                                         : BallSide::Outside;
  }
  if (surface_.isSigned && !surface_.lattice.isWhole()) doubt(centres, progress, sides);
}

/// Takes balls for near that hold no surface, but may hold points of both sides of the threshold, as in
/// holes.
void FarBalls::doubt(std::span<const glm::dvec3> centres, Progress& progress, std::span<BallSide> sides) {
  const std::vector<uint32_t> far =
      parallelSelect(centres.size(), [&](uint32_t c) { return sides[c] != BallSide::Near; });
  std::vector<glm::dvec3> points;
  for (const uint32_t c : far) points.push_back(centres[c]);
  queryPoints(surface_, PointsView(points), {.distance = false, .winding = true}, progress, found_);
  constexpr size_t kBallsAtATime = 64;
  parallelFor(far.size(), kBallsAtATime, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k)
      if (!isSettled(points[k], std::abs(double(found_.winding[k])))) sides[far[k]] = BallSide::Near;
  });
}

/// Returns whether the winding number stays on its side of the threshold in a whole ball without surface.
bool FarBalls::isSettled(const glm::dvec3& centre, double winding) const {
  const double error = surface_.rims.count() <= kRimsOfSmallError ? kErrorOfSomeRims : kErrorOfManyRims;
  const double gap = std::abs(winding - surface_.threshold) - error;
  return gap > 0.0 && radius_ * surface_.rims.mostGradient(centre - surface_.mesh.origin, radius_) < gap;
}

}  // namespace raymap::cpu
