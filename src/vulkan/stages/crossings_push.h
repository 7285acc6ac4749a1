#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kCrossingsGroup = 128;
RAYMAP_CONSTANT uint kFewSteps = 128;  // Steps up to which one invocation scans a triangle; one per line.
RAYMAP_CONSTANT uint kRowSteps = 4;    // Steps that the beginning of a row takes.
RAYMAP_CONSTANT uint kRunLines = 32;   // Lines in a run, at most: part of a row of a larger triangle.
RAYMAP_CONSTANT uint kMostRuns = 1u << 31;

// All zero before the stage begins.
struct CrossingsStatus {
  uint reach;           // Largest |coordinate| of all corners: bits of a float, in the floats' order.
  uint tooFarCorner;    // First corner beyond the computable range: ~(3 * triangle + corner).
  uint runs, runsHigh;  // Number of runs, 64 bits.
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
  RAYMAP_ADDRESS(Ints) lines[3];  // w_l of every lattice edge, by axis; see vulkan/stages/crossings.h.
  RAYMAP_ADDRESS(Uints) runs;  // Per triangle: the number of its runs, then the number of runs before them.
  RAYMAP_ADDRESS(CrossingsStatusAddress) status;
  RAYMAP_ADDRESS(Uints)
  crossed;  // Bits of the crossed edges (crossed_edges.glsl); 0: not requested.
  uvec3 dims;
  uint triangleCount;
  uint crossedWords;
  uint firstGroup;  // Number of groups before this dispatch.
};
RAYMAP_CHECK_SIZE(CrossingsPush, 88);

RAYMAP_SHARED_END
