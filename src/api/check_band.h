#pragma once

#include <raymap/narrow_band.h>

namespace raymap {

/// Throws `Error(Usage)` for a lattice or a narrow band that makes no sense, or that needs a sign without
/// one.
void checkBand(const Grid& grid, const BandOptions& options, bool isSigned);

}  // namespace raymap
