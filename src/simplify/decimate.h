#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "mesh/packed_mesh.h"
#include "simplify/collapsible_mesh.h"
#include "simplify/face_point_lists.h"
#include "simplify/given_surface.h"
#include "simplify/plane_quadric.h"

namespace raymap {

/// Lengths are in the mesh's units.
struct DecimateOptions {
  double tolerance;  ///< Largest distance from points of the given mesh to the new one.
  double step;       ///< Largest distance between these points.
};

/// Removes vertices of a closed mesh while points of the given mesh stay within a tolerance of it.
class Decimator {
 public:
  static constexpr double kEdgePoints = 4.0;  ///< Points of a new edge that are measured, for each step.

  /// Throws `Error(Input)` if the mesh is not a closed, oriented manifold.
  Decimator(const PackedMesh& mesh, const DecimateOptions& options);

  /// Collapses edges while any can be. Threads share the work by tiles; the tiles decide the result.
  void run(Progress& progress);
  /// Undoes the last collapse at each of these faces, and never removes their vertices again. Returns whether
  /// there was any.
  bool undoAt(std::span<const uint32_t> faces);
  /// Collapses edges where collapses were undone.
  void runAgain();

  const CollapsibleMesh& mesh() const { return mesh_; }
  /// Points of the given mesh: its vertices, and points on its sharp edges and large faces.
  std::span<const glm::vec3> points() const { return points_.points(); }

 private:
  using Ring = CollapsibleMesh::Ring;
  struct NewFaces;
  struct Task;

  glm::dvec3 at(uint32_t vertex) const { return glm::dvec3(vertices_[vertex]); }
  void addPlanes();
  void runTiles(double shift, Progress& progress);
  bool isSurroundedByTile(uint32_t v) const;
  void reduce(Task& task);
  bool removeVertex(uint32_t v, double most, Task& task);
  bool collapse(uint32_t v, const Ring& ring, uint32_t k, Task& task);
  bool makeFaces(uint32_t v, const Ring& ring, uint32_t k, NewFaces& faces) const;
  bool placePoints(uint32_t v, const Ring& ring, NewFaces& faces, Task& task) const;
  bool staysNear(const Ring& ring, uint32_t k) const;

  std::span<const glm::vec3> vertices_;
  DecimateOptions options_;
  double limit_;  ///< Square of the tolerance.
  CollapsibleMesh mesh_;
  GivenSurface given_;
  FacePointLists points_;
  std::vector<glm::vec3> normals_;  ///< Normals of the given faces.
  std::vector<PlaneQuadric> quadrics_;
  std::vector<float> wake_;      ///< Cost from which on a vertex is tried again.
  std::vector<uint32_t> tile_;   ///< Tile of each vertex.
  std::vector<uint8_t> isFree_;  ///< Whether a vertex and its neighbours belong to one task.
  std::vector<uint8_t> isKept_;  ///< Whether a vertex must not be removed.
};

}  // namespace raymap
