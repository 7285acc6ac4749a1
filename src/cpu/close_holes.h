#pragma once

#include <functional>
#include <span>
#include <vector>

#include "cell_mesh.h"
#include "hole_rims.h"
#include "progress.h"
#include "ray_map.h"

namespace raymap {

/// A lattice edge at which the sign changes although no triangle crosses it: surface is missing there.
struct MissingEdge {
  uint32_t sample;  ///< Leads from here to the next sample along `axis`.
  uint8_t axis;
  uint8_t rimCubes;    ///< Bit c: triangles do cross a sign change of cube c around it; see `cubeAround`.
  bool isInsideFirst;  ///< `sample` is inside, the next one outside.
};

/// Cubes have eight neighbouring samples for corners; cube (i, j, k) has sample (i, j, k) for its highest. So
/// those at the grid's rim reach beyond it. The four around an edge, as seen against its direction
/// counter-clockwise from the lowest on.
glm::ivec3 cubeAround(const glm::ivec3& sample, int axis, int c);

/// All missing edges, in the order of their samples.
std::vector<MissingEdge> findMissingEdges(const RayMap& map, const Buffer<float>& winding, double threshold,
                                          Progress& progress);

/// Gives the winding numbers of the mesh's triangles at some points, in cell units.
using WindingSource = std::function<std::vector<float>(std::span<const glm::vec3> points)>;

/// Surface that closes holes, in cell units, turned outward.
struct HolePatch {
  std::vector<glm::uvec3> triangles;
  CellMesh mesh;  ///< Refers to `triangles`.

  void clear();
  double area() const;  ///< In faces of a cell.
  size_t bytes() const { return triangles.capacity() * sizeof(glm::uvec3) + mesh.vertices.capacityBytes(); }
};

/// Bytes that closing holes may hold, but for the patch's tree.
size_t patchBytes(size_t missingEdges);

/// The surface |w| = threshold where it is missing: two triangles across each missing edge. It ends on the
/// mesh's rims.
void makePatch(const CellMesh& mesh, std::span<const MissingEdge> edges, const Buffer<float>& winding,
               double threshold, const WindingSource& windingAt, Progress& progress, HolePatch& patch);

}  // namespace raymap
