#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

struct WindingRimsPush {
  RAYMAP_ADDRESS(Ints) rays[3];     // The ray map, by axis.
  RAYMAP_ADDRESS(Floats) values;    // Values of the lattice.
  RAYMAP_ADDRESS(Floats) rims;      // Two ends of three coordinates each, in cell units.
  RAYMAP_ADDRESS(Uints) computed;   // Places of the samples to compute, if they are listed.
  RAYMAP_ADDRESS(Floats) distance;  // Unsigned distance in cells.
  RAYMAP_ADDRESS(Floats) change;    // The largest change of the numbers (winding_doubts.comp), or null.
  uvec3 dims;                       // Samples of the grid.
  uint level;                       // Level of the lattice, which has every 2^level-th sample.
  uint count;                       // Samples to compute or to look at.
  uint rimCount;
  float threshold;
  vec3 centre;  // Of the rims.
  uint source;  // What the numbers near the threshold come from.
  uint unused;
};
RAYMAP_CHECK_SIZE(WindingRimsPush, 112);

RAYMAP_SHARED_END
