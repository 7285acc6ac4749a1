#pragma once

#include <raymap/machine.h>
#include <raymap/mesh_view.h>

namespace raymap {

/// How to simplify a mesh. Lengths are in the mesh's units.
struct SimplifyOptions {
  /// Largest distance of points of either mesh to the other. 0 keeps the mesh; with `triangles`, it is no
  /// limit.
  double tolerance = 0.0;
  /// Distance between these points; 0 = ten times the tolerance, or a quarter of the mean edge of
  /// `triangles`, at least the mesh's own mean edge. It is enlarged until all points are at most about a
  /// million, and 32 for each face.
  double step = 0.0;
  /// Most triangles of the result, 0 = no limit. The tolerance is then the least that was found to reach it.
  /// A warning tells if the shape or `tolerance` does not allow so few.
  size_t triangles = 0;
};

/// A simplified mesh.
struct Simplified {
  Mesh mesh = {};
  double tolerance = 0.0;  ///< Tolerance that was in force; 0 = the mesh was kept.
  double deviation = 0.0;  ///< Largest distance measured from points of either mesh to the other.
  size_t undone = 0;       ///< Number of faces at which a check failed, so that edge collapses were undone.
};

/// Returns a mesh with fewer faces, on some of the vertices of a watertight mesh. It stays watertight and
/// consistently oriented, no closed part turns inside out, and no faces cross that did not cross before. All
/// this is checked, and collapses are undone where a check fails. If checks fail in spite of that, the result
/// is the given mesh. Vertices at the same position are taken as one if the mesh is not watertight otherwise.
/// Same mesh, same result, for any number of threads. `machine.threads`, `warn` and `progress` are used.
///
/// A mesh with at most `SimplifyOptions::triangles` is kept. If no tolerance reaches this number, or not the
/// given one, the result has the fewest triangles that were found, and a warning says so.
///
/// Throws `Error`: Usage for the options, Input if the mesh is not a closed, oriented manifold, Memory,
/// Cancelled.
RAYMAP_API Simplified simplify(const MeshView& mesh, const SimplifyOptions& options,
                               const MachineOptions& machine = {});

}  // namespace raymap
