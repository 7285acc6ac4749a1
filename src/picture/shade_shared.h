#ifdef __cplusplus
#pragma once
#include <glm/vec2.hpp>
#endif

// Numbers of shading, the same on every backend.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

#ifdef __cplusplus
#define RAYMAP_REAL2 glm::dvec2
#else
#define RAYMAP_REAL2 vec2
#endif

// Positions of the four antialiasing samples in a pixel: a rotated square. Near-horizontal and near-vertical
// edges get all four levels with it.
RAYMAP_CONSTANT uint kSubPixelCount = 4;
RAYMAP_CONSTANT RAYMAP_REAL2 kSubPixels[kSubPixelCount] = {
    {0.375, 0.125}, {0.875, 0.375}, {0.625, 0.875}, {0.125, 0.625}};

// Light on the floor: in full shadow and under full occlusion, and what the sun and the open sky add.
RAYMAP_CONSTANT RAYMAP_REAL kFloorInShadow = 0.55;
RAYMAP_CONSTANT RAYMAP_REAL kFloorSun = 0.45;
RAYMAP_CONSTANT RAYMAP_REAL kFloorOccluded = 0.45;
RAYMAP_CONSTANT RAYMAP_REAL kFloorSky = 0.55;

// The same for the cut face, which only occlusion darkens.
RAYMAP_CONSTANT RAYMAP_REAL kCutOccluded = 0.6;
RAYMAP_CONSTANT RAYMAP_REAL kCutSky = 0.4;

// Lines on the cut face: strength of isolines, pixels between two at which they vanish, widths in pixels.
RAYMAP_CONSTANT RAYMAP_REAL kIsoLineStrength = 0.45;
RAYMAP_CONSTANT RAYMAP_REAL kIsoLinePixels = 3.0;
RAYMAP_CONSTANT RAYMAP_REAL kIsoLineWidth = 1.2;
RAYMAP_CONSTANT RAYMAP_REAL kContourWidth = 2.8;
// Numbers that change less than this share of the step of lines across a sample are a plateau: they get no
// lines.
RAYMAP_CONSTANT RAYMAP_REAL kPlainValues = 1e-3;

// Parts of the light that clay sends back: in all directions, of the sky at grazing angles, as highlights.
RAYMAP_CONSTANT RAYMAP_REAL kDiffusePart = 0.5;
RAYMAP_CONSTANT RAYMAP_REAL kGrazingPart = 0.25;
RAYMAP_CONSTANT RAYMAP_REAL kGrazingPower = 5.0;
RAYMAP_CONSTANT RAYMAP_REAL kShinePart = 0.12;
RAYMAP_CONSTANT RAYMAP_REAL kShinePower = 50.0;
RAYMAP_CONSTANT float kNothingThere = 3.402823466e38f;  // Distance to what is seen where nothing is.
// Light that is shown as white. Highlights are compressed instead of clipped.
RAYMAP_CONSTANT RAYMAP_REAL kWhite = 4.0;

RAYMAP_SHARED_END
