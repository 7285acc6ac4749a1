#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/packed_mesh.h"
#include "method/turns.h"

namespace raymap::cpu {

struct PreparedSurface;

/// Does what `countCrossings` does for one segment, among some faces of a mesh and in double precision.
/// Points are in the mesh's units, relative to its origin. Empty turns take all faces as given. The result is
/// `kUnsure` if rounding could still change it: where the segment meets an edge, or a point lies in a face.
int32_t countFaceCrossings(const PackedMesh& mesh, const Turns& turns, std::span<const uint32_t> faces,
                           const glm::dvec3& from, const glm::dvec3& to);

/// Returns by how much the faces of a prepared mesh change the winding number between two points near each
/// other, in the mesh's units. `faces` is room to work in.
int32_t crossingsBetween(const PreparedSurface& surface, const glm::dvec3& from, const glm::dvec3& to,
                         std::vector<uint32_t>& faces);

}  // namespace raymap::cpu
