#pragma once

#include "features.h"
#include "shared/cell_levels.h"
#include "shared/cell_mesh.h"
#include "shared/cell_runs.h"
#include "shared/crossings.h"

namespace raymap::vulkan {

/// What stages find out while they run, for the host. Those that did not run leave their part as it was.
struct Findings {
  CellMeshStatus mesh;
  CrossingsStatus crossings;
  CellRunsTotals lists[kMostLevels];
  uint32_t doubtful;  ///< Samples whose rays disagree.
};
static_assert(sizeof(Findings) == kStatusWords * sizeof(uint32_t));

}  // namespace raymap::vulkan
