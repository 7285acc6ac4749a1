#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRestrictX = 8;  // Coarse samples per work group that restricts residuals.
RAYMAP_CONSTANT uint kRestrictY = 4;
RAYMAP_CONSTANT uint kRestrictZ = 4;
RAYMAP_CONSTANT uint kMostCoarsest = 17;  // Maximum number of samples of the coarsest lattice along an axis.

// Parameters of all kernels of the harmonic solve: a lattice, its values, and the next coarser lattice.
struct WindingHarmonicPush {
  RAYMAP_ADDRESS(Ints) rays[3];            // The ray map, by axis.
  RAYMAP_ADDRESS(Floats) values;           // Values of the lattice.
  RAYMAP_ADDRESS(Floats) rightHandSide;    // Right-hand side of its equations; 0: taken from the ray map.
  RAYMAP_ADDRESS(Floats) coarse;           // Values of the next coarser lattice.
  RAYMAP_ADDRESS(Floats) coarseEquations;  // Right-hand side of its equations.
  uvec3 dims;                              // Samples of the grid.
  uint level;                              // Level of the lattice, which has every 2^level-th sample.
  uint colour;                             // Half of the samples to relax.
  float factor;                            // Factor of over-relaxation of the coarsest lattice.
  uint firstGroup;                         // Number of groups before this dispatch.
  uint unused;
};
RAYMAP_CHECK_SIZE(WindingHarmonicPush, 88);

RAYMAP_SHARED_END
