#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "mesh/packed_mesh.h"
#include "repair/collapsible_mesh.h"

namespace raymap {

/// Sum of the squared distances to planes, weighted by areas (Garland & Heckbert 1997).
struct PlaneQuadric {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0, x = 0.0, y = 0.0, z = 0.0, one = 0.0;

  void addPlane(const glm::dvec3& normal, const glm::dvec3& point, double weight);
  void add(const PlaneQuadric& other);
  /// Returns the mean square of a point's distances to the planes.
  double meanSquare(const glm::dvec3& p) const;
};

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
  std::span<const glm::vec3> points() const { return points_; }

 private:
  using Ring = CollapsibleMesh::Ring;
  struct NewFaces;
  struct Task;
  /// A given vertex, and the place of a face in the list of those around it.
  struct NearFace {
    uint32_t vertex, place = 0;
  };

  glm::dvec3 at(uint32_t vertex) const { return glm::dvec3(vertices_[vertex]); }
  void listFaces();
  void listNeighbours();
  void addPlanes();
  void addPoints();
  void addPoint(uint32_t face, const glm::vec3& point);
  void runTiles(double shift, Progress& progress);
  bool isSurroundedByTile(uint32_t v) const;
  void reduce(Task& task);
  bool removeVertex(uint32_t v, double most, Task& task);
  bool collapse(uint32_t v, const Ring& ring, uint32_t k, Task& task);
  bool makeFaces(uint32_t v, const Ring& ring, uint32_t k, NewFaces& faces) const;
  bool placePoints(uint32_t v, const Ring& ring, NewFaces& faces, Task& task) const;
  bool staysNear(const Ring& ring, uint32_t k) const;
  bool isNearGiven(uint32_t start, uint32_t end) const;
  uint32_t walkTo(const glm::dvec3& p, uint32_t vertex) const;
  std::span<const uint32_t> givenFaces(uint32_t vertex) const { return atVertex(facesOfVertex_, vertex); }
  std::span<const uint32_t> givenNeighbours(uint32_t vertex) const { return atVertex(neighbours_, vertex); }
  std::span<const uint32_t> atVertex(const std::vector<uint32_t>& all, uint32_t vertex) const {
    return std::span(all).subspan(firstFace_[vertex], firstFace_[vertex + 1] - firstFace_[vertex]);
  }
  bool isNearFacesOf(const glm::dvec3& p, NearFace& near) const;
  bool hasFaceWithin(std::span<const uint32_t> faces, const glm::dvec3& p) const;
  void putPoint(uint32_t point, uint32_t face);
  void takePoint(uint32_t point);
  void spreadPoints(std::span<const uint32_t> faces);

  std::span<const glm::vec3> vertices_;
  std::span<const glm::uvec3> triangles_;
  std::vector<uint32_t> firstFace_;      ///< Place of each vertex in the next two.
  std::vector<uint32_t> facesOfVertex_;  ///< The given faces around each vertex.
  std::vector<uint32_t> neighbours_;     ///< The neighbours of each vertex in the given mesh, as many.
  DecimateOptions options_;
  double limit_;  ///< Square of the tolerance.
  CollapsibleMesh mesh_;
  std::vector<glm::vec3> normals_;  ///< Normals of the given faces.
  std::vector<PlaneQuadric> quadrics_;
  std::vector<glm::vec3> points_;
  std::vector<uint32_t> firstPoint_, nextPoint_;  ///< List of the points at each face.
  std::vector<uint32_t> faceOfPoint_;             ///< `kNoIndex` for vertices that a face uses.
  std::vector<float> wake_;                       ///< Cost from which on a vertex is tried again.
  std::vector<uint32_t> tile_;                    ///< Of each vertex.
  std::vector<uint8_t> isFree_;                   ///< Whether a vertex and its neighbours belong to one task.
  std::vector<uint8_t> isKept_;                   ///< Whether a vertex must not be removed.
};

}  // namespace raymap
