#pragma once

#include <raymap/machine.h>
#include <raymap/mesh_view.h>

namespace raymap {

/// How to simplify a mesh. Lengths are in the mesh's units.
struct SimplifyOptions {
  double tolerance = 0.0;  ///< Largest distance of points of either mesh to the other; 0 keeps the mesh.
  double step = 0.0;       ///< Distance between these points; 0 = ten times the tolerance.
};

/// A simplified mesh.
struct Simplified {
  Mesh mesh = {};
  double deviation = 0.0;  ///< Largest distance measured from points of either mesh to the other.
  size_t undone = 0;       ///< Number of faces at which a check failed, so that edge collapses were undone.
};

/// Returns a mesh with fewer faces, on some of the vertices of a watertight mesh. It stays watertight and
/// consistently oriented, no closed part turns inside out, and no faces cross that did not cross before. All
/// this is checked, and collapses are undone where a check fails. If checks fail in spite of that, the result
/// is the given mesh. Same mesh, same result, for any number of threads. `machine.threads` and `progress`
/// count.
///
/// Throws `Error`: Usage for the options, Input if the mesh is not a closed, oriented manifold, Memory,
/// Cancelled.
RAYMAP_API Simplified simplify(const MeshView& mesh, const SimplifyOptions& options,
                               const MachineOptions& machine = {});

}  // namespace raymap
