#pragma once

#include "base/progress.h"
#include "repair/solid/given.h"

namespace raymap {

/// Walls that became thicker. Shares are of the mesh's area.
struct Thickened {
  double share = 0.0;       ///< Share on plates.
  double grownShare = 0.0;  ///< Share on walls that became more than twice as thick.
  double thinnest = 0.0;    ///< Thickness that a hundredth of these walls does not exceed.
  double median = 0.0;      ///< Thickness that half of them does not exceed.
};

/// Returns the thickness of the plates: that of the options, or the least that no samples miss.
double leastThickness(const RepairOptions& repair, const Grid& grid);

/// Unites a solid with plates of `leastThickness` in place of what is thinner in the mesh, or missed by the
/// samples: around the middle between the two sides of walls, and around sheets. `solid` is the mesh's field,
/// moved by the offset.
Thickened thickenThinParts(Given& given, Field& solid, Progress& progress);

}  // namespace raymap
