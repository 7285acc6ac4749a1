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
  uint rays;  // Rays of a pixel, 1 or 4.
};

layout(location = 0) uniform PagePush push;
layout(location = 200) uniform highp sampler3D samples;
layout(location = 0) out vec4 colour;

float trilinear(vec3 q) {
  return texture(samples, (q + 0.5) / vec3(push.shape.nx, push.shape.ny, push.shape.nz)).r;
}

#include "scene/shade.glsl"

void main() {
  const vec2 pixel = vec2(gl_FragCoord.x - 0.5, float(push.height) - gl_FragCoord.y - 0.5);
  vec3 sum = vec3(0);
  float away;
  for (uint i = 0; i < push.rays; ++i)
    sum += light(push.scene, pixel + (push.rays == 1 ? vec2(0.5) : kSubPixels[i]), away);
  colour = vec4(encodeSrgb(sum / push.rays), 1);
}
