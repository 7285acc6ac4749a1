#pragma once

#include <raymap/field.h>
#include <raymap/machine.h>

#include <span>

namespace raymap {

// Distances between the samples of a field. Points and distances are in the mesh's units; gradients have no
// unit. Let h be the grid's spacing.
//
// Within the box of the outermost samples, the distance is trilinear between the eight samples around the
// point. A grid with one sample along an axis is constant along it inside that box, which is flat there.
//
// Outside, the result is a lower bound on the signed distance, as exact as the samples are, or NaN if
// `Outside::NaN` asks for it. Let q be the point of the box that is closest to the point p, x one of the
// samples around q and d(x) its distance. The bound is the largest of these:
// - d(x) - |p - x|, because a distance field is 1-Lipschitz; not if d(x) is clamped to -band;
// - the distance to `Field::surfaceBounds`, if p lies outside of them;
// - sqrt(|p - q|^2 + max(d(x) - |q - x|, 0)^2), if the box holds `Field::surfaceBounds`.
// It is up to 0.71 h less than the distance interpolated at the border. Far from a surface that the box
// holds, it is nearly the distance. Where the bounds are not known, or reach beyond the box around p, it
// falls with the way from the box, and below 0: p may lie inside of what the box does not hold. A point
// outside the bounds is outside the solid.
//
// The bound holds where the field has the sign of a closed surface. Across a hole the sign of an open mesh
// jumps although the distance is not 0: a point inside, seen from samples outside through a hole, gets a
// bound that may be too large. A bound is that of the distances and `surfaceBounds` that the field has:
// whoever moves the surface by writing distances updates `surfaceBounds`, or empties it.
//
// The gradient is a central difference, h to either side along each axis, of the distance in the box, and
// outside of sqrt(|p - q|^2 + max(d(q), 0)^2). It is continuous. For an exact field, it has nearly length 1
// away from edges of the surface. Outside, it leads away from the box, whatever surfaces there may be beyond
// it.
//
// Clamped distances (`Field::clampDistance`) are interpolated as stored; gradients vanish where all are
// clamped. The result is NaN where one of the samples around the point is, and for points that are NaN. The
// gradient of an infinite point is NaN.

// A narrow band gives the same bits as the field that `toDense` makes of it, without its memory.

/// Results of points outside the box of the outermost samples.
enum class Outside {
  Bound,  ///< A lower bound on the distance, and a gradient that leads away from the box.
  NaN     ///< NaN, for the gradient too.
};

/// Options of `sample`.
struct SampleOptions {
  bool gradients = false;            ///< Whether to compute gradients; they take six distances each.
  Outside outside = Outside::Bound;  ///< Results of points outside the box.
};

/// Results in the order of the points.
struct Samples {
  Buffer<float> distance = {};      ///< One per point.
  Buffer<glm::vec3> gradient = {};  ///< One per point, or empty.
};

/// Returns the distance at a point. Throws `Error(Usage)` if the field has no distances.
RAYMAP_API double distanceAt(const Field& field, const glm::dvec3& point, Outside outside = Outside::Bound);

/// Returns the gradient of the distance at a point. Throws `Error(Usage)` if the field has no distances.
RAYMAP_API glm::dvec3 gradientAt(const Field& field, const glm::dvec3& point,
                                 Outside outside = Outside::Bound);

/// Samples many points in parallel. A point's results do not depend on the others. Only
/// `threads` of `machine` is used. Throws `Error`: Usage if the field has no distances, Memory.
RAYMAP_API Samples sample(const Field& field, std::span<const glm::dvec3> points,
                          const SampleOptions& options = {}, const MachineOptions& machine = {});
/// Does the same, reusing the memory of `result`.
RAYMAP_API void sample(const Field& field, std::span<const glm::dvec3> points, const SampleOptions& options,
                       Samples& result, const MachineOptions& machine = {});

}  // namespace raymap
