#pragma once

#include <raymap/buffer.h>
#include <raymap/surface.h>

#include <variant>
#include <vector>

namespace raymap {

/// How to choose points on a surface, near it and around it. The defaults are those of mesh_to_sdf: of 50
/// points, 47 are near the surface, half of them with each deviation.
struct SamplePointsOptions {
  size_t count = 500'000;     ///< Number of all points.
  double surfaceShare = 0.0;  ///< Share of the points that are on the surface, 0 to 1.
  double nearShare = 0.94;    ///< Share of the points that are near the surface, 0 to 1.
  /// Standard deviations of the offsets of points near the surface, as shares of the bounding sphere's
  /// radius. Each gets as many points.
  std::vector<double> sigmas = {0.0025, 0.00025};
  uint64_t seed = 0;  ///< Another seed gives other points.
  bool normalize =
      false;  ///< Whether to move and scale all so that the bounding sphere becomes the unit sphere about 0.
  /// Length of the mesh that becomes 1, about the centre of its bounds, in place of the bounding sphere's
  /// radius; 0 = as `normalize` says.
  double unit = 0.0;
  bool inCube = false;  ///< Whether to choose the points all around from a cube instead of a ball.
  double radius = 0.0;  ///< Radius of that ball, half a side of that cube; 0 = the bounding sphere's radius.
};

/// Points with signed distances: those on the surface, then those near it, then those in the bounding sphere.
struct PointSamples {
  Buffer<glm::dvec3> points = {};    ///< Positions: (position in the mesh - centre) * scale.
  Buffer<double> distance = {};      ///< Distances in the units of the points, negative inside.
  Buffer<glm::dvec3> gradient = {};  ///< Gradients of the distance: unit vectors that point outwards.
  glm::dvec3 centre{0.0};            ///< Point of the mesh that lies at 0 in `points`.
  double scale = 1.0;                ///< Length in `points` of one unit of the mesh.
};

/// Returns the number of points on the surface, near it with each deviation, and in the bounding sphere, in
/// this order. Throws `Error(Usage)` for shares and deviations that make no sense.
RAYMAP_API std::vector<size_t> samplePointCounts(const SamplePointsOptions& options);

/// Returns points near a surface with their signed distances, as for training DeepSDF.
///
/// - Points on the surface are chosen evenly by area. They have the distance 0, and the normal as their
///   gradient. It points to the outside, however the face is wound. If both sides are inside or both outside,
///   it points to that whose winding number is closer to 0. The face decides where both numbers are equally
///   close, as beside a sheet.
/// - Points near the surface are such points plus normally distributed offsets along x, y and z.
/// - The others lie evenly in the bounding sphere, or the ball or cube that the options ask for. It is about
///   the centre of the mesh's bounds. The bounding sphere reaches the farthest vertex.
///
/// Points are rounded to single precision before their distances are measured, so that files have the right
/// signs. Where steps of single precision exceed a sixteenth of the least deviation, far from 0, points keep
/// double precision.
///
/// Points of the same mesh and options are the same, bit for bit, on any machine and for any number of
/// threads. Distances are, on the same kind of processor.
///
/// Only `threads` and `progress` of the machine's options are used. Throws `Error`: Usage for the options and
/// for a surface without a sign, Input if the mesh has no area (all of its faces are degenerate), Memory,
/// Cancelled.
RAYMAP_API PointSamples samplePoints(const Surface& surface, const SamplePointsOptions& options = {},
                                     const MachineOptions& machine = {});

/// Rows x, y, z, distance, in single precision if all coordinates are numbers of it, else in double
/// precision.
using SampleRows = std::variant<std::vector<glm::vec4>, std::vector<glm::dvec4>>;

/// Returns the rows of the points that are inside, or of the others.
RAYMAP_API SampleRows sampleRows(const PointSamples& samples, bool areInside);

}  // namespace raymap
