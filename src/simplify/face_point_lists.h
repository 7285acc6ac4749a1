#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "simplify/collapsible_mesh.h"

namespace raymap {

/// Area of a mesh, and the length of all sides of its faces.
struct FaceSums {
  double area = 0.0, sides = 0.0;
};
FaceSums sumFaces(const PackedMesh& mesh);

/// Returns the least distance between points, from `step` on, with which the faces of a mesh have at most a
/// million points and 32 for each face, beside one each. A vertex far away would else give its faces
/// billions.
double boundedStep(const PackedMesh& mesh, double step);

/// Points of a given mesh, and which of them are at each face of its simplification: its vertices, once they
/// are removed, and points on its sharp edges and large faces. Threads may change the lists of different
/// faces.
class FacePointLists {
 public:
  /// `mesh` is the given mesh before the first collapse. Points on it are about `step` apart.
  FacePointLists(const PackedMesh& given, const CollapsibleMesh& mesh, double step, double tolerance);

  std::span<const glm::vec3> points() const { return points_; }

  void put(uint32_t point, uint32_t face);
  void take(uint32_t point);
  /// Empties the list of a face. Its points must be put elsewhere.
  void clear(uint32_t face) { first_[face] = kNoIndex; }
  /// Returns whether a condition holds for all points at a face. Asks until it does not.
  template <class Condition>
  bool allOf(uint32_t face, Condition&& holds) const {
    for (uint32_t point = first_[face]; point != kNoIndex; point = next_[point])
      if (!holds(point)) return false;
    return true;
  }
  /// Gives the points at these faces of the simplification to the closest of them.
  void spread(std::span<const uint32_t> faces, const CollapsibleMesh& mesh);

 private:
  void add(uint32_t face, const glm::vec3& point);

  PackedMesh given_;
  std::vector<glm::vec3> points_;       ///< First the vertices.
  std::vector<uint32_t> first_, next_;  ///< First point at each face, and the point after each point.
  std::vector<uint32_t> face_;          ///< `kNoIndex` for vertices that a face uses.
};

}  // namespace raymap
