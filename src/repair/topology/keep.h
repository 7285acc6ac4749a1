#pragma once

#include <raymap/repair.h>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Returns whether these counts find nothing wrong with a mesh: every edge has two faces that agree, the
/// faces point outwards, and none is degenerate or a duplicate.
bool looksRight(const Diagnostics& found);

/// Returns whether holes are all that these counts find wrong with a mesh.
bool hasOnlyHoles(const Diagnostics& found);

/// Keeps the faces of a mesh that looks right and has no crossing faces, unless its parts overlap or face the
/// wrong way. Drops small parts only if `RepairOptions::dropSmaller` is set; warns of them else. Returns
/// whether it kept the faces.
bool keepFaces(const PackedMesh& mesh, const RepairOptions& repair, const WarningCallback& warn,
               Repaired& repaired);

}  // namespace raymap
