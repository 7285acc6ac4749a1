#pragma once

#include <raymap/repair.h>

#include "mesh/packed_mesh.h"
#include "repair/solid/thin_parts.h"

namespace raymap {

/// Warns that a mesh is a sheet, unless an option says what to make of it. `found` must not be brief.
void warnOfSheet(const Diagnostics& found, const RepairOptions& repair, const WarningCallback& warn);

/// Warns of a result that leaves the mesh's bounds, moved by the offset and grown by plates, by more than two
/// samples. `isCut` tells that the box of the samples cut it off.
void warnOfBounds(const PackedMesh& mesh, const Mesh& result, const Grid& grid, const RepairOptions& repair,
                  bool isCut, const WarningCallback& warn);

/// Warns of walls that became more than twice as thick, unless a least thickness was asked for.
void warnOfThickened(const PackedMesh& mesh, const Thickened& thickened, const RepairOptions& repair,
                     double thickness, const WarningCallback& warn);

/// Warns of bodies that lie loose in the hollows of `result`, and did not before it was hollowed out.
void warnOfLooseBodies(const Mesh& before, const Mesh& result, const WarningCallback& warn);

/// Warns of hollows and drain holes that were asked for but not made.
void warnOfHoles(const RepairReport& report, const RepairOptions& repair, const WarningCallback& warn);

}  // namespace raymap
