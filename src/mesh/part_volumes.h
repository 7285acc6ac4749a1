#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Returns the signed volume of each of `parts` parts of a mesh, from the part of each face. Adds up
/// tetrahedra from the first corner of a part, in the order of the faces.
std::vector<double> partVolumes(const PackedMesh& mesh, std::span<const uint32_t> partOfFace, size_t parts);

}  // namespace raymap
