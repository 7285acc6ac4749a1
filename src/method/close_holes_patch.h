#pragma once

#include <raymap/field.h>
#include <raymap/options.h>

#include <functional>
#include <span>
#include <vector>

#include "method/backend_concepts.h"
#include "method/close_holes_rims.h"

namespace raymap {

/// Returns cube c (0 to 3) of the four around the lattice edge that starts at `sample`. Seen against the
/// edge's direction, the cubes run counter-clockwise from the lowest on. A cube's corners are eight
/// neighbouring samples. Cube (i, j, k) has sample (i, j, k) as its highest corner, so cubes at the grid's
/// border reach beyond it.
glm::ivec3 cubeAround(const glm::ivec3& sample, int axis, int c);

/// Function that returns the winding numbers of the mesh's triangles at points in cell units.
using WindingSource = std::function<std::vector<float>(std::span<const glm::vec3> points)>;

/// Surface that closes holes, in cell units. Its triangles face outward.
struct HolePatch {
  std::vector<glm::uvec3> triangles;
  CellMesh mesh;  ///< Refers to `triangles`.

  void clear();
  /// Returns the area in squares of cells.
  double area() const;
  size_t bytes() const { return triangles.capacity() * sizeof(glm::uvec3) + mesh.vertices.capacityBytes(); }
};

/// Builds the surface |w| = threshold where it is missing, with two triangles across each missing edge. It
/// ends on the mesh's rims. `edges` must be sorted by sample, then by axis.
void makePatch(const CellMesh& mesh, std::span<const MissingEdge> edges, double threshold,
               const WindingSource& windingAt, Progress& progress, HolePatch& patch);

/// Throws `Error(Memory)` if a patch over this many missing edges is too large for the memory left. Its
/// search tree needs `treeBytes` as well.
void requirePatch(size_t missingEdges, size_t treeBytes, size_t bytesLeft);

/// Runs the stage `close_holes`, after `winding_dipoles`. Leaves the distance to the mesh and patch together.
template <HostBackend B>
void closeHoles(B& backend) {
  // If the six rays agree everywhere, triangles account for every change of the winding number.
  if (backend.doubtfulShare() == 0.0) return;
  const std::vector<MissingEdge> edges = backend.missingEdges();
  if (edges.empty()) return;
  requirePatch(edges.size(), B::patchTreeBytes(2 * edges.size()), backend.bytesLeft());
  makePatch(
      backend.cellMesh(), edges, backend.options().threshold,
      [&](std::span<const glm::vec3> points) { return backend.windingAt(points); }, backend.progress(),
      backend.patch());
  backend.addPatch();
}

}  // namespace raymap
