#pragma once

#include <raymap/narrow_band.h>

#include <functional>
#include <span>
#include <vector>

#include "base/progress.h"

namespace raymap {

/// Queries of a scene, and lower bounds on distances in it.
struct SceneBounds {
  /// Returns the distances of points up to a largest one.
  std::function<Buffer<double>(std::span<const glm::dvec3>, double most)> distances;
  /// Does the same for the union of those bodies whose distances change no faster than a point moves.
  std::function<Buffer<double>(std::span<const glm::dvec3>, double most)> steadyDistances;
  /// Returns a lower bound on the distances to all other bodies within a radius about a point.
  std::function<double(const glm::dvec3&, double radius)> lowerBound;
  double slack;  ///< Exceeds the errors of distances near the surface.
};

/// Returns the narrow band of a scene. Throws `Error(Memory)` if its leaves need more than `most` bytes.
Field makeSceneBand(const Grid& grid, const BandOptions& options, const SceneBounds& bounds, size_t most,
                    Progress& progress);

}  // namespace raymap
