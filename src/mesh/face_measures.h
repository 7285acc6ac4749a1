#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/parallel.h"
#include "mesh/model.h"

namespace raymap {

inline bool hasRepeatedCorner(const glm::uvec3& face) {
  return face.x == face.y || face.y == face.z || face.z == face.x;
}

/// Returns whether a triangle is lower than 1e-6 of its longest edge.
bool isFlat(const std::array<glm::dvec3, 3>& corners);

/// Area and volume of a face, and what is wrong with it. The volume is that of the tetrahedron from a centre.
struct FaceMeasure {
  double area = 0.0, volume = 0.0;
  bool isDegenerate = false, isSurface = false;
};

/// Measures a face. One with a repeated corner belongs to no surface.
FaceMeasure measureFace(const PackedMesh& mesh, const Welding& welding, size_t face,
                        const glm::dvec3& centre);

/// Calls `visit(face, measure)` for each face, in order. So sums do not depend on the number of threads,
/// which measure the faces.
template <class Visit>
void forEachFaceMeasure(const Model& mesh, const glm::dvec3& centre, Visit&& visit) {
  constexpr size_t kFacesPerTask = size_t{1} << 13, kFacesPerRound = size_t{1} << 17;
  const Welding& welding = mesh.welding();  // Before threads ask for it.
  Buffer<FaceMeasure> measures(std::min(kFacesPerRound, mesh.triangles.size()));
  for (size_t first = 0; first < mesh.triangles.size(); first += kFacesPerRound) {
    const size_t count = std::min(kFacesPerRound, mesh.triangles.size() - first);
    parallelFor(count, kFacesPerTask, [&](size_t begin, size_t end) {
      for (size_t f = begin; f < end; ++f) measures[f] = measureFace(mesh, welding, first + f, centre);
    });
    for (size_t f = 0; f < count; ++f) visit(first + f, measures[f]);
  }
}

}  // namespace raymap
