#pragma once

#include <raymap/repair.h>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Returns whether these counts find nothing wrong with a mesh: every edge has two faces that agree, the
/// faces point outwards, and none is degenerate or a duplicate.
bool looksRight(const Diagnostics& found);

/// Returns whether holes are all that these counts find wrong with a mesh.
bool hasOnlyHoles(const Diagnostics& found);

/// Returns whether no faces cross, and the search for them is complete.
bool crossesNowhere(const SelfIntersections& crossing);

/// Keeps the faces of a mesh that looks right, has no crossing faces, and whose parts lie right. Drops small
/// parts only if `RepairOptions::dropSmaller` is set; warns of them else.
void keepFaces(const PackedMesh& mesh, const RepairOptions& repair, const WarningCallback& warn,
               Repaired& repaired);

}  // namespace raymap
