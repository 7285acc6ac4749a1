#pragma once

#include "base/progress.h"
#include "repair/solid/given.h"

namespace raymap {

/// Unites a solid with plates of thickness `RepairOptions::minThickness` in place of what is thinner in the
/// mesh: around the middle between the two sides of walls, and around sheets. `solid` is the mesh's field,
/// moved by the offset. Returns the share of the mesh's area that is thinner.
double thickenThinParts(Given& given, Field& solid, Progress& progress);

}  // namespace raymap
