#pragma once

#include <cstdint>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Divides the faces of a mesh at empty slabs across an axis, at least `gap` thick, and each group again in
/// the same way. Faces ascend, and groups are in the order of their first faces.
std::vector<std::vector<uint32_t>> groupsApart(const PackedMesh& mesh, double gap);

/// Returns some faces of a mesh with the vertices that they use, in their order.
Mesh partOf(const PackedMesh& mesh, const std::vector<uint32_t>& faces);

}  // namespace raymap
