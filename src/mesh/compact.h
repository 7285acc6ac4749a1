#pragma once

#include <cstdint>
#include <vector>

#include "mesh/packed_mesh.h"
#include "mesh/weld.h"

namespace raymap {

class Model;

/// Removes the vertices that no face uses. The others keep their order.
void removeUnusedVertices(Mesh& mesh);

/// Returns a mesh with one vertex for each position that vertices share, and all positions in the same order.
Mesh weldedCopy(const Model& mesh);
/// Does the same for another welding, and returns the first vertex at each position in `firsts`.
Mesh weldedCopy(const PackedMesh& mesh, const Welding& welding, std::vector<uint32_t>& firsts);

}  // namespace raymap
