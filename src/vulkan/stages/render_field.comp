// Draws one ray of a pixel per invocation. GPU twin of cpu/render/shade.cpp.
#include "vulkan/device/kernel.glsl"
#include "picture/drawn_scene_shared.h"
#include "picture/sphere_trace_shared.h"

#include "vulkan/stages/render_field_push.h"

layout(constant_id = 1) const uint kHasNumbers = 0;  // Whether numbers are in colour; takes more registers.
layout(constant_id = 2) const uint kIsBand = 0;  // Whether the field is a narrow band.
layout(constant_id = 3) const uint kCountsSteps = 0;  // Whether steps are counted; takes more registers.
layout(push_constant, scalar) uniform Push { RenderFieldPush push; };

const float kNotKnown = kLargestFloat;  // A number that a narrow band does not know.

shared vec3 lights[kRenderGroup];
shared float depths[kRenderGroup];
shared uint stepCounts[kRenderGroup];
uint samplings = 0;  // Number of times that this ray sampled the field; counted only if steps are.

#include "vulkan/stages/trilinear.glsl"
ivec3 shapeDims() {
  return ivec3(push.shape.nx, push.shape.ny, push.shape.nz);
}

#include "picture/drawn_field.glsl"

float trilinear(vec3 q) {
  if (kCountsSteps != 0) ++samplings;
  bool isKnown;
  const float value = kIsBand != 0 ? betweenLeaves(push.samples, q, isKnown) : between(push.samples, shapeDims(), q);
  return clamp(push.scale * value, -kFarthestRay, kFarthestRay);
}

float plateauLength(vec3 p, vec3 direction, out float value) {
  return kIsBand != 0 ? emptyLength(p, direction, value) : 0;
}

#include "picture/shade.glsl"

float valueAt(vec3 p) {
  const vec3 q = max(vec3(0), min(p, vec3(shapeDims() - 1)));
  if (kIsBand != 0) {
    bool isKnown;
    const float inLeaves = betweenLeaves(push.values, q, isKnown);
    return isKnown ? inLeaves : kNotKnown;
  }
  const float value = between(push.values, shapeDims(), q);
  return push.picture.at[0].colours.isDifference != 0 ? push.scale * value - trilinear(q) : value;
}

vec4 stopAt(uint i) {
  return push.picture.at[0].colours.stops[i];
}

#include "picture/colouring.glsl"

vec3 numberColour(RenderSceneData scene, vec3 p, float pixel) {
  if (kIsBand != 0 && valueAt(p) == kNotKnown) return push.picture.at[0].colours.unknown.rgb;
  return valueColour(scene, p, pixel, push.picture.at[0].colours.stopCount, push.picture.at[0].colours.lineStep);
}

vec3 sliceColour(RenderSceneData scene, vec3 p, float slope) {
  const float d = fieldDistance(p);
  const float far = min(abs(d) / scene.sliceRange, 1);
  const vec3 ground = d < 0 ? insideColour(scene, d)
                      : far < 0.5 ? mix(scene.outside[0], scene.outside[1], 2 * far)
                                  : mix(scene.outside[1], scene.outside[2], 2 * far - 1);
  return drawLines(scene, ground, d, slope, scene.lineStep);
}

// Returns the light of a point of the picture. Notes the distance from the eye to what is seen there first, so that no
// register holds it while the shadows are traced.
vec3 light(RenderSceneData scene, vec2 at, uint local) {
  float skipped;
  const Ray ray = cameraRay(scene, at, skipped);
  const float t = traceRay(ray);
  if (kCountsSteps != 0) stepCounts[local] = samplings;
  const float slice = traceSlice(scene, ray, skipped);
  const bool isSlice = slice < kFarthestRay && (t < 0 || slice < t);
  depths[local] = isSlice ? skipped + slice : t >= 0 ? skipped + t : kNothingThere;
  if (kHasNumbers != 0 && (isSlice || t >= 0)) {
    const float seen = isSlice ? slice : t;
    const vec3 p = ray.origin + seen * ray.direction;
    if (isSlice || isOnCutFace(p)) return numberColour(scene, p, (skipped + seen) * scene.pixelAngle);
    if (push.picture.at[0].colours.isOnSurface != 0) {
      const float value = valueAt(p);
      scene.clay = kIsBand != 0 && value == kNotKnown ? push.picture.at[0].colours.unknown.rgb
                                                     : colourOf(value, push.picture.at[0].colours.stopCount);
    }
  }
  if (isSlice) return sliceColour(scene, ray.origin + slice * ray.direction, (skipped + slice) * scene.pixelAngle);
  return t >= 0 ? surface(scene, ray, t, skipped) : background(scene, ray, at, skipped);
}

uint encoded(vec3 linear) {
  const uvec3 bytes = uvec3(255 * encodeSrgb(linear) + 0.5);
  return bytes.r | bytes.g << 8 | bytes.b << 16 | 0xff000000u;
}

void main() {
  const uint local = gl_LocalInvocationID.x;
  const uint tiles = ceilDiv(push.width, kRenderTile);
  const uvec2 tile = uvec2(groupIndex() % tiles, groupIndex() / tiles);
  const uint inTile = local / kSubPixelCount;
  uvec2 pixel = tile * kRenderTile + uvec2(inTile % kRenderTile, inTile / kRenderTile);
  const bool isInside = pixel.x < push.width && pixel.y < push.rows;
  pixel.y += push.firstRow;
  if (isInside) lights[local] = light(push.picture.at[0].scene, vec2(pixel) + kSubPixels[local % kSubPixelCount], local);
  barrier();
  if (!isInside || local % kSubPixelCount != 0) return;
  const vec3 sum = lights[local] + lights[local + 1] + lights[local + 2] + lights[local + 3];
  const uint at = pixel.y * push.width + pixel.x;
  push.pixels.at[at] = encoded(0.25 * sum);
  if (kCountsSteps != 0) {
    const uint steps = stepCounts[local] + stepCounts[local + 1] + stepCounts[local + 2] + stepCounts[local + 3];
    atomicAdd(push.steps.at[0], (steps + 2) / 4);
  }
  if (uint64_t(push.depth) == 0) return;
  const float nearest = min(min(depths[local], depths[local + 1]), min(depths[local + 2], depths[local + 3]));
  push.depth.at[at] = nearest < kNothingThere ? nearest / push.scale : nearest;
}
