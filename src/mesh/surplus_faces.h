#pragma once

#include <cstdint>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Returns those of some repeated faces without which the mesh is as balanced at every edge as with them, or
/// more. They should be ignored. The others should not: where two solids share a face, each has a side there.
std::vector<uint32_t> surplusFaces(const PackedMesh& mesh, std::vector<uint32_t> repeated);

}  // namespace raymap
