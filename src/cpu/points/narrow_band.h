#pragma once

#include <raymap/narrow_band.h>

#include "base/progress.h"
#include "cpu/points/prepared_surface.h"

namespace raymap::cpu {

/// Makes the narrow band of a surface on a lattice. Throws `Error(Memory)` if it takes more than `most`
/// bytes.
Field makeNarrowBand(const PreparedSurface& surface, const Grid& grid, const BandOptions& options,
                     size_t most, Progress& progress);

}  // namespace raymap::cpu
