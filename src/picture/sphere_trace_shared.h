#ifdef __cplusplus
#pragma once
#endif

// Numbers of sphere tracing, the same on every backend. Lengths are in samples.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

// Farther than any ray goes; its square is still a finite float.
RAYMAP_CONSTANT RAYMAP_REAL kFarthestRay = 1e15;
// The ball around the shape in which rays step is larger than the shape by this.
RAYMAP_CONSTANT RAYMAP_REAL kBallMargin = 2.0;
// Points at most this far from the cut are on its face.
RAYMAP_CONSTANT RAYMAP_REAL kCutTolerance = 1e-2;

// Share of the distance that a step takes. Across creases the trilinear value of an exact distance changes by
// up to sqrt(3) per sample.
RAYMAP_CONSTANT RAYMAP_REAL kCaution = 0.9;
// Least step. It bounds the loop. Nothing thinner exists between samples.
RAYMAP_CONSTANT RAYMAP_REAL kLeastStep = 0.05;

// A hit is refined to this tolerance, in at most this many steps. A secant step ends between these shares.
RAYMAP_CONSTANT int kHitSteps = 24;
RAYMAP_CONSTANT RAYMAP_REAL kHitTolerance = 1e-4;
RAYMAP_CONSTANT RAYMAP_REAL kLeastSecant = 0.01;
RAYMAP_CONSTANT RAYMAP_REAL kMostSecant = 0.99;

// Tangent of the light's angular radius.
RAYMAP_CONSTANT RAYMAP_REAL kLightSize = 0.11;
// Distance, in samples, to a surface of which nothing is known.
RAYMAP_CONSTANT RAYMAP_REAL kNothingNear = 1e9;
// Shadow rays start here, and end where less of the light is left than `kDark`.
RAYMAP_CONSTANT RAYMAP_REAL kShadowStart = 0.5;
RAYMAP_CONSTANT RAYMAP_REAL kDark = 0.01;

// From this share of a band's width on, a distance is taken as clamped.
RAYMAP_CONSTANT RAYMAP_REAL kClampedShare = 0.999;

// Heights above a surface at which its surroundings are measured, as shares of the shape's radius; the factor
// from one height's weight to the next one's; and the share of the light that full occlusion takes.
RAYMAP_CONSTANT int kHeights = 5;
RAYMAP_CONSTANT RAYMAP_REAL kHeightShares[kHeights] = {0.015, 0.035, 0.07, 0.13, 0.22};
RAYMAP_CONSTANT RAYMAP_REAL kHeightFading = 0.8;
RAYMAP_CONSTANT RAYMAP_REAL kOcclusion = 1.1;

RAYMAP_SHARED_END
