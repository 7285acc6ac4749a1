// Draws a field in a browser: as `renderField` does, with a slice through it if that is wanted.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "picture/drawn_scene_shared.h"
#include "picture/shade_shared.h"
#include "picture/sphere_trace_shared.h"

struct PagePush {
  RenderShape shape;
  RenderSceneData scene;
  uint width, height;
  uint rays;           // Rays of a pixel, 1 or 4.
  uint colours;        // What they show: 0, distances; 1, `values`; 2, `values` on the surface too.
  vec4 stops[kMostStops];  // Colours, and the values in w that have them, ascending.
  uint stopCount;
  float lineStep;      // Between iso-lines.
};

layout(location = 0) uniform PagePush push;
layout(location = 200) uniform highp sampler3D samples;
layout(location = 201) uniform highp sampler3D values;
layout(location = 0) out vec4 colour;

float trilinear(vec3 q) {
  return texture(samples, (q + 0.5) / vec3(push.shape.nx, push.shape.ny, push.shape.nz)).r;
}

float plateauLength(vec3 p, vec3 direction, out float value) {
  return 0;  // The field is dense.
}

#include "picture/shade.glsl"

float valueAt(vec3 p) {
  return texture(values, (p + 0.5) / vec3(push.shape.nx, push.shape.ny, push.shape.nz)).r;
}

vec4 stopAt(uint i) {
  return push.stops[i];
}

#include "picture/colouring.glsl"

// Returns the colour of a point inside. `pixel` is a pixel's size there.
vec3 pointColour(vec3 p, float pixel) {
  if (push.colours != 0) return valueColour(push.scene, p, pixel, push.stopCount, push.lineStep);
  const float d = fieldDistance(p);
  return drawLines(push.scene, colourOf(d, push.stopCount), d, pixel, push.lineStep);
}

vec3 seen(vec2 at) {
  float skipped;
  const Ray ray = cameraRay(push.scene, at, skipped);
  const float slice = traceSlice(push.scene, ray, skipped);
  const float t = traceRay(ray);
  if (slice < kFarthestRay && (t < 0 || slice < t))
    return pointColour(ray.origin + slice * ray.direction, (skipped + slice) * push.scene.pixelAngle);
  if (t < 0) return background(push.scene, ray, at, skipped);
  const vec3 p = ray.origin + t * ray.direction;
  if (push.colours != 0 && isOnCutFace(p)) return pointColour(p, (skipped + t) * push.scene.pixelAngle);
  RenderSceneData scene = push.scene;
  if (push.colours == 2) scene.clay = colourOf(valueAt(p), push.stopCount);
  return surface(scene, ray, t, skipped);
}

void main() {
  const vec2 pixel = vec2(gl_FragCoord.x - 0.5, float(push.height) - gl_FragCoord.y - 0.5);
  vec3 sum = vec3(0);
  for (uint i = 0; i < push.rays; ++i) sum += seen(pixel + (push.rays == 1 ? vec2(0.5) : kSubPixels[i]));
  colour = vec4(encodeSrgb(sum / push.rays), 1);
}
