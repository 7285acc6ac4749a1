#pragma once

#include <cstdint>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Returns the faces of each group that is apart from the others: a slab across an axis, `gap` thick, lies
/// between them, or between groups that hold them. Faces ascend, and groups are in the order of their first
/// faces.
std::vector<std::vector<uint32_t>> groupsApart(const PackedMesh& mesh, double gap);

/// Returns some faces of a mesh with the vertices that they use, in their order.
Mesh partOf(const PackedMesh& mesh, const std::vector<uint32_t>& faces);

}  // namespace raymap
