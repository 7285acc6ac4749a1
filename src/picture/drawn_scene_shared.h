#ifndef RAYMAP_SHARED_SCENE_H  // No pragma: GLSL also includes this more than once.
#define RAYMAP_SHARED_SCENE_H

#ifdef __cplusplus
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

#ifdef __cplusplus
using glm::vec3;
using glm::vec4;
#endif

// Data of picture/shape.h, without the samples.
struct RenderShape {
  vec3 centre;
  float radius;
  vec3 cutNormal;   // 0 for an uncut shape.
  float cutOffset;  // Largest float for an uncut shape.
  float level, wall, band, innerBand;
  uint nx, ny, nz;
};
RAYMAP_CHECK_SIZE(RenderShape, 60);

RAYMAP_CONSTANT uint kMostStops = 11;  // Of a colouring.

// Further data of picture/drawn_scene.h. Colours are linear.
struct RenderSceneData {
  vec3 eye, right, up, forward;
  vec3 floorNormal;
  float floorHeight;
  vec3 toLight;
  float pixelAngle;
  float lineStep;
  float depth;
  vec3 sun, sky, bounce, clay;
  vec3 top, bottom;  // Background.
  vec3 inside[3];    // Cut face: at the surface, half way, deepest.
  vec3 contour;
  vec3 sliceNormal;  // 0 for no slice.
  float sliceOffset;
  float sliceRange;  // Distance, in spacings, at which the colours of the slice are deepest.
  vec3 outside[3];   // Slice: at the surface, half way, farthest.
};
RAYMAP_CHECK_SIZE(RenderSceneData, 264);

// Data of a colouring of picture/colouring.h.
struct RenderColours {
  vec4 stops[kMostStops];  // Colours, and in w their numbers.
  uint stopCount;
  float lineStep;
  uint isDifference;  // Whether the distances are subtracted from the numbers.
  uint isOnSurface;   // Whether they colour the surface too.
  vec4 unknown;       // Where a narrow band does not know the number.
};
RAYMAP_CHECK_SIZE(RenderColours, 208);

RAYMAP_SHARED_END

#endif
