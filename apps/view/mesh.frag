// Faces in plain light with lines along their edges, hidden where the field's surface is in front.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "mesh_buffers.glsl"
#include "mesh_push.h"

layout(push_constant, scalar) uniform Push { MeshPush push; };
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 weights;
layout(location = 0) out vec4 colour;

#include "hidden.glsl"

const float kLineWidth = 1.2;
const float kBackOfDefect = 0.7;  // Share of the light of a front.
const vec3 kFront = vec3(0.62, 0.68, 0.76), kBack = vec3(0.30, 0.27, 0.27), kLine = vec3(0.08, 0.11, 0.18);

void main() {
  const vec3 fromEdges = weights / fwidth(weights);
  const float pixels = min(fromEdges.x, min(fromEdges.y, fromEdges.z));
  // Where triangles are only a few pixels high, lines would cover all.
  const vec3 heights = 1 / fwidth(weights);
  const float strength = clamp(min(heights.x, min(heights.y, heights.z)) / 4 - 0.5, 0, 1);
  const float line = strength * clamp(0.5 * kLineWidth + 0.5 - pixels, 0, 1);
  const vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  const bool isSolid = push.colour != kNoFaces;
  if (isHidden(place) || (!isSolid && line == 0)) discard;
  const float facing = abs(dot(normal, normalize(place)));
  const vec3 chosen = unpackUnorm4x8(push.colour).rgb;
  const vec3 side = push.colour == kPlainFaces ? (gl_FrontFacing ? kFront : kBack)
                                               : chosen * (gl_FrontFacing ? 1 : kBackOfDefect);
  const vec3 face = side * (0.35 + 0.65 * facing);
  colour = isSolid ? vec4(mix(face, kLine, 0.7 * line), 1) : vec4(kLine, 0.7 * line);
}
