// Draws three vertices of each triangle, which it reads by their indices.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "mesh_buffers.glsl"
#include "mesh_push.h"

layout(push_constant, scalar) uniform Push { MeshPush push; };
layout(location = 0) out vec3 place;
layout(location = 1) out vec3 weights;

void main() {
  const uint corner = gl_VertexIndex % 3;
  place = push.vertices.at[push.indices.at[gl_VertexIndex]] + push.origin;
  weights = vec3(corner == 0, corner == 1, corner == 2);
  gl_Position = push.toClip * vec4(place, 1);
}
