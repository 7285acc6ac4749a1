#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kCrossingsGroup = 128;
RAYMAP_CONSTANT uint kFewSteps = 128;  // One invocation scans a triangle in so many steps, each a line
RAYMAP_CONSTANT uint kRowSteps = 4;    // or the beginning of a row, which takes as long as these,
RAYMAP_CONSTANT uint kRunLines = 32;   // and of a larger one no more than so many lines of a row: a run.
RAYMAP_CONSTANT uint kMostRuns = 1u << 31;

// All zero before the stage begins.
struct CrossingsStatus {
  uint reach;         // The largest |coordinate| of all corners, as the bits of a float, which sort like it.
  uint tooFarCorner;  // Of the first corner beyond what can be computed: ~(3 * triangle + corner).
  uint runs, runsHigh;  // How many runs there are, with 64 bits.
};
RAYMAP_CHECK_SIZE(CrossingsStatus, 16);

#ifndef __cplusplus
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CrossingsStatusAddress {
  CrossingsStatus now;
};
#endif

struct CrossingsPush {
  RAYMAP_ADDRESS(Floats) vertices;
  RAYMAP_ADDRESS(Uints) triangles;
  RAYMAP_ADDRESS(Ints) lines[3];  // w_l of every lattice edge along x, y and z; see vulkan/crossings.h.
  RAYMAP_ADDRESS(Uints) runs;     // Of each triangle: how many there are, or how many come before them.
  RAYMAP_ADDRESS(CrossingsStatusAddress) status;
  RAYMAP_ADDRESS(Uints)
  crossed;  // Bits of the edges that are crossed (crossed_edges.glsl); 0: not asked for.
  uint dims[3];
  uint triangleCount;
  uint crossedWords;
  uint unused;
};
RAYMAP_CHECK_SIZE(CrossingsPush, 88);

RAYMAP_SHARED_END
