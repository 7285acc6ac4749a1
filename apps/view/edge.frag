// Draws edges in one colour, hidden where the field's surface is in front.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "mesh_buffers.glsl"
#include "mesh_push.h"

layout(push_constant, scalar) uniform Push { MeshPush push; };
layout(location = 0) in vec3 place;
layout(location = 0) out vec4 colour;

#include "hidden.glsl"

void main() {
  if (isHidden(place)) discard;
  colour = unpackUnorm4x8(push.colour);
}
