// Draws a field in a browser: as `renderField` does, with a slice through it if that is wanted.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "scene/scene_shared.h"
#include "scene/shade_shared.h"
#include "scene/sphere_trace_shared.h"

struct PagePush {
  RenderShape shape;
  RenderSceneData scene;
  uint width, height;
  uint rays;           // Rays of a pixel, 1 or 4.
  vec3 sliceNormal;    // 0 for no slice.
  float sliceOffset;
  float range;         // Largest distance, in spacings, for the colours of the slice.
  vec3 outside[3];     // Colours of the slice: at the surface, half way, farthest.
};

layout(location = 0) uniform PagePush push;
layout(location = 200) uniform highp sampler3D samples;
layout(location = 0) out vec4 colour;

float trilinear(vec3 q) {
  return texture(samples, (q + 0.5) / vec3(push.shape.nx, push.shape.ny, push.shape.nz)).r;
}

#include "scene/shade.glsl"

// Returns the ray's parameter where it meets the slice inside the grid; negative if it does not.
float traceSlice(Ray ray) {
  const float across = dot(ray.direction, push.sliceNormal);
  if (across == 0) return -1;
  const float t = (push.sliceOffset - dot(ray.origin, push.sliceNormal)) / across;
  const vec3 p = ray.origin + t * ray.direction;
  const vec3 last = vec3(push.shape.nx, push.shape.ny, push.shape.nz) - 1;
  return all(greaterThanEqual(p, vec3(-0.5))) && all(lessThanEqual(p, last + 0.5)) ? t : -1;
}

vec3 sliceColour(vec3 p, float slope) {
  const float d = fieldDistance(p);
  const float far = min(abs(d) / push.range, 1);
  const vec3 ground = d < 0 ? insideColour(push.scene, d)
                      : far < 0.5 ? mix(push.outside[0], push.outside[1], 2 * far)
                                  : mix(push.outside[1], push.outside[2], 2 * far - 1);
  return drawLines(push.scene, ground, d, slope);
}

vec3 seen(vec2 at) {
  float skipped;
  const Ray ray = cameraRay(push.scene, at, skipped);
  const float slice = traceSlice(ray);
  const float t = traceRay(ray);
  if (slice >= 0 && (t < 0 || slice < t))
    return sliceColour(ray.origin + slice * ray.direction, (skipped + slice) * push.scene.pixelAngle);
  if (t >= 0) return surface(push.scene, ray, t, skipped);
  return background(push.scene, ray, at, skipped);
}

void main() {
  const vec2 pixel = vec2(gl_FragCoord.x - 0.5, float(push.height) - gl_FragCoord.y - 0.5);
  vec3 sum = vec3(0);
  for (uint i = 0; i < push.rays; ++i) sum += seen(pixel + (push.rays == 1 ? vec2(0.5) : kSubPixels[i]));
  colour = vec4(encodeSrgb(sum / push.rays), 1);
}
