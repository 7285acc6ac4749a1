#pragma once

#include <raymap/field.h>

#include <span>

namespace raymap {

// Distances between the samples of a field. Points and distances are in the mesh's units; gradients have no
// unit. Let h be the grid's spacing.
//
// Within the box of the outermost samples, the distance is trilinear between the eight samples around the
// point. A grid with one sample along an axis is constant along it inside that box, which is flat there.
//
// Outside, only a lower bound is known. Let q be the closest point of the box, and d(q) its distance. The
// result is sqrt(|p - q|^2 + max(d(q), 0)^2). No surface inside the box is closer to p, but for the error of
// the interpolation: a sphere tracer may step by it. It is always positive: a solid that reaches the box ends
// there. Fields made with `Options::invert` must not be sampled outside their box.
//
// The gradient is a central difference of these distances, h to either side along each axis. It is continuous
// and, for an exact field away from edges of the surface, has nearly length 1. Within h of the box and
// outside it, the lower bound takes part.
//
// Clamped distances (`Field::band`) are interpolated as stored; gradients vanish where all are clamped. The
// result is NaN where one of the samples around the point is, and for points that are NaN; it is infinite for
// infinite points, and their gradient is NaN.

/// Options of `sample`.
struct SampleOptions {
  bool gradients = false;  ///< Whether to compute gradients; they take six distances each.
  int threads = 0;         ///< Number of threads; 0 = all.
};

/// Results in the order of the points.
struct Samples {
  Buffer<float> distance = {};      ///< One per point.
  Buffer<glm::vec3> gradient = {};  ///< One per point, or empty.
};

/// Returns the distance at a point. Throws `Error(Usage)` if the field has no distances.
RAYMAP_API double distanceAt(const Field& field, const glm::dvec3& point);

/// Returns the gradient of the distance at a point. Throws `Error(Usage)` if the field has no distances.
RAYMAP_API glm::dvec3 gradientAt(const Field& field, const glm::dvec3& point);

/// Samples many points in parallel. A point's results do not depend on the others. Throws `Error`: Usage if
/// the field has no distances, Memory.
RAYMAP_API Samples sample(const Field& field, std::span<const glm::dvec3> points,
                          const SampleOptions& options = {});
/// Does the same, reusing the memory of `result`.
RAYMAP_API void sample(const Field& field, std::span<const glm::dvec3> points, const SampleOptions& options,
                       Samples& result);

}  // namespace raymap
