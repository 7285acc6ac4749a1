#pragma once

#include <cstdint>
#include <span>

#include "mesh/packed_mesh.h"
#include "method/turns.h"

namespace raymap::cpu {

/// Does what `countCrossings` does for one segment, among some faces of a mesh and in double precision.
/// Points are in the mesh's units, relative to its origin. Empty turns take all faces as given. The result is
/// `kUnsure` if rounding could still change it: where the segment meets an edge, or a point lies in a face.
int32_t countFaceCrossings(const PackedMesh& mesh, const Turns& turns, std::span<const uint32_t> faces,
                           const glm::dvec3& from, const glm::dvec3& to);

}  // namespace raymap::cpu
