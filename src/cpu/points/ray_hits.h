#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/packed_mesh.h"
#include "method/turns.h"

namespace raymap::cpu {

/// Point in which a ray passes a face.
struct RayHit {
  double distance;    ///< From the start of the ray, in the mesh's units.
  glm::dvec3 normal;  ///< Unit normal of the face, in the direction of the ray or across it.
  uint32_t triangle;  ///< The face.
  int32_t change;     ///< By how much the winding number changes there.
};

/// Finds where a ray passes some faces of a mesh, nearest first. The start is relative to the mesh's origin,
/// the direction has length 1. Empty turns take all faces as given. A ray through an edge passes one of its
/// two faces, and a ray through a vertex passes a closed surface there as if it were moved a little.
void findRayHits(const PackedMesh& mesh, const Turns& turns, std::span<const uint32_t> faces,
                 const glm::dvec3& from, const glm::dvec3& direction, std::vector<RayHit>& hits);

}  // namespace raymap::cpu
