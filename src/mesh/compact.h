#pragma once

#include "mesh/packed_mesh.h"

namespace raymap {

/// Removes the vertices that no face uses. The others keep their order.
void removeUnusedVertices(Mesh& mesh);

/// Returns a mesh with one vertex for each position that vertices share, and all positions in the same order.
Mesh weldedCopy(const PackedMesh& mesh);

}  // namespace raymap
