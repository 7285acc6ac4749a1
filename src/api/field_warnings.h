#pragma once

#include <raymap/grid.h>
#include <raymap/machine.h>
#include <raymap/options.h>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Warns if no directions of the faces fit the crossings.
void warnOfMisfit(const Stats& stats, const WarningCallback& warn);

/// Warns of parts that are inside out and cross others.
void warnOfInvertedParts(const Stats& stats, const WarningCallback& warn);

/// Warns that no sample is inside, though a sign was asked for, if the mesh lies in the grid.
void warnOfNothingInside(const PackedMesh& mesh, const Grid& grid, const MachineOptions& machine);

}  // namespace raymap
