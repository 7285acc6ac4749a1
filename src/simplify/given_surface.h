#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Tells whether points are within a tolerance of a given mesh, by walks over its vertices. Much faster than
/// a search for the closest face, but a walk may end too early.
class GivenSurface {
 public:
  /// `limit` is the square of the tolerance.
  GivenSurface(const PackedMesh& mesh, double limit);

  /// Returns whether the middles of the parts of an edge between two vertices are near, as far as a walk
  /// tells.
  bool isNearEdge(uint32_t start, uint32_t end, int parts) const;

 private:
  /// A vertex, and the place of a face in the list of those around it.
  struct NearFace {
    uint32_t vertex, place = 0;
  };

  void listFaces();
  void listNeighbours();
  glm::dvec3 at(uint32_t vertex) const { return glm::dvec3(mesh_.vertices[vertex]); }
  std::span<const uint32_t> facesOf(uint32_t vertex) const { return atVertex(faces_, vertex); }
  std::span<const uint32_t> neighboursOf(uint32_t vertex) const { return atVertex(neighbours_, vertex); }
  std::span<const uint32_t> atVertex(const std::vector<uint32_t>& all, uint32_t vertex) const {
    return std::span(all).subspan(starts_[vertex], starts_[vertex + 1] - starts_[vertex]);
  }
  uint32_t walkTo(const glm::dvec3& p, uint32_t vertex) const;
  bool isNearFacesOf(const glm::dvec3& p, NearFace& near) const;
  bool hasFaceWithin(std::span<const uint32_t> faces, const glm::dvec3& p) const;

  PackedMesh mesh_;
  double limit_;
  std::vector<uint32_t> starts_;      ///< Place of each vertex in the next two.
  std::vector<uint32_t> faces_;       ///< Faces around each vertex.
  std::vector<uint32_t> neighbours_;  ///< Neighbours of each vertex, as many.
};

}  // namespace raymap
