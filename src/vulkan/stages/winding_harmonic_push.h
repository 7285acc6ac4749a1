#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRestrictX = 8;  // Coarse samples of a work group that restricts residuals.
RAYMAP_CONSTANT uint kRestrictY = 4;
RAYMAP_CONSTANT uint kRestrictZ = 4;
RAYMAP_CONSTANT uint kMostCoarsest = 17 * 17 * 17;  // Samples of the coarsest lattice.

// Of every kernel of the harmonic solve: a lattice, what lies on it, and the next coarser one.
struct WindingHarmonicPush {
  RAYMAP_ADDRESS(Ints) rays[3];          // The ray map, by axis.
  RAYMAP_ADDRESS(Floats) values;         // Of the lattice.
  RAYMAP_ADDRESS(Floats) rightHandSide;  // What its equations ask for; 0: what the ray map does.
  RAYMAP_ADDRESS(Floats) coarse;         // Values of the next coarser lattice.
  uint gridX, gridY, gridZ;              // Samples of the grid.
  uint level;                            // Of the lattice: it holds every 2^level-th sample.
  uint colour;                           // Which half of the samples to relax.
  float factor;                          // Of over-relaxation.
};
RAYMAP_CHECK_SIZE(WindingHarmonicPush, 72);

RAYMAP_SHARED_END
