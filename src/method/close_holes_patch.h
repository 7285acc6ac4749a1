#pragma once

#include <raymap/generate.h>

#include <functional>
#include <span>
#include <vector>

#include "method/backend.h"
#include "method/close_holes_rims.h"

namespace raymap {

/// Cubes have eight neighbouring samples for corners; cube (i, j, k) has sample (i, j, k) for its highest. So
/// those at the grid's rim reach beyond it. The four around an edge, as seen against its direction
/// counter-clockwise from the lowest on.
glm::ivec3 cubeAround(const glm::ivec3& sample, int axis, int c);

/// Gives the winding numbers of the mesh's triangles at some points, in cell units.
using WindingSource = std::function<std::vector<float>(std::span<const glm::vec3> points)>;

/// Surface that closes holes, in cell units, turned outward.
struct HolePatch {
  std::vector<glm::uvec3> triangles;
  CellMesh mesh;  ///< Refers to `triangles`.

  void clear();
  double area() const;  ///< In squares of cells.
  size_t bytes() const { return triangles.capacity() * sizeof(glm::uvec3) + mesh.vertices.capacityBytes(); }
};

/// The surface |w| = threshold where it is missing: two triangles across each missing edge. It ends on the
/// mesh's rims. The edges are in the order of their samples and axes.
void makePatch(const CellMesh& mesh, std::span<const MissingEdge> edges, double threshold,
               const WindingSource& windingAt, Progress& progress, HolePatch& patch);

/// Throws `Error(Memory)` if a patch over so many missing edges is too large for the memory left, where each
/// of its triangles takes `bytesPerTriangle` besides.
void requirePatch(size_t missingEdges, size_t bytesPerTriangle, size_t bytesLeft);

/// The stage `close_holes`, after `winding_dipoles`. Leaves the distance to the mesh and the patch together.
template <HostBackend B>
void closeHoles(B& backend) {
  // Where the six rays agree, triangles account for every change of the winding number.
  if (backend.doubtfulShare() == 0.0) return;
  const std::vector<MissingEdge> edges = backend.missingEdges();
  if (edges.empty()) return;
  requirePatch(edges.size(), B::kTreeBytesPerTriangle, backend.bytesLeft());
  makePatch(
      backend.cellMesh(), edges, backend.options().threshold,
      [&](std::span<const glm::vec3> points) { return backend.windingAt(points); }, backend.progress(),
      backend.patch());
  backend.addPatch();
}

}  // namespace raymap
