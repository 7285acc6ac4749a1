#pragma once

#include <raymap/field.h>
#include <raymap/repair.h>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Unites a solid with plates of thickness `RepairOptions::minThickness` in place of what is thinner in the
/// mesh: around the middle between the two sides of walls, and around sheets. `solid` is the mesh's field,
/// moved by the offset. Returns the share of the mesh's area that is thinner. `options` are those of the
/// field.
double thickenThinParts(const PackedMesh& mesh, const Options& options, const RepairOptions& repair,
                        Field& solid);

}  // namespace raymap
