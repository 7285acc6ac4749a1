#pragma once

#include <raymap/surface_pair.h>

#include "cpu/points/prepared_surface.h"

namespace raymap::cpu {

/// Returns the points of two surfaces that are least apart, in the coordinates of `a`. `pose` takes those of
/// `b` to them. Surfaces that are `most` or more apart get that.
SurfacePair closestPair(const PreparedSurface& a, const PreparedSurface& b, const glm::dmat4& pose,
                        double most, Progress& progress);

/// Returns the point that is farthest from the other surface, as `Surface::hausdorff` says.
SurfacePair farthestPoint(const PreparedSurface& a, const PreparedSurface& b, const HausdorffOptions& options,
                          Progress& progress);

}  // namespace raymap::cpu
