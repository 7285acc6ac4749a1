#pragma once

#include "base/progress.h"
#include "repair/solid/given.h"

namespace raymap {

/// Returns the thickness of the plates: that of the options, or the least that no samples miss.
double leastThickness(const RepairOptions& repair, const Grid& grid);

/// Unites a solid with plates of `leastThickness` in place of what is thinner in the mesh, or missed by the
/// samples: around the middle between the two sides of walls, and around sheets. `solid` is the mesh's field,
/// moved by the offset. Returns the share of the mesh's area that is thinner.
double thickenThinParts(Given& given, Field& solid, Progress& progress);

}  // namespace raymap
