// Draws edges as bands of constant width: two triangles each, between two vertices that it reads by their indices.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "mesh_buffers.glsl"
#include "mesh_push.h"

layout(push_constant, scalar) uniform Push { MeshPush push; };
layout(location = 0) out vec3 place;

const float kHalfWidth = 1.25;  // In pixels.

// Returns the width and height of the picture, in pixels. The first two rows of the matrix are as long as half of it
// is wide and high.
vec2 pictureSize() {
  const mat4 rows = transpose(push.toClip);
  return push.width * vec2(1, length(rows[0].xyz) / length(rows[1].xyz));
}

void main() {
  const uint edge = gl_VertexIndex / 6, corner = gl_VertexIndex % 6;
  vec3 places[2];
  vec4 ends[2];
  for (uint e = 0; e < 2; ++e) {
    places[e] = push.vertices.at[push.indices.at[2 * edge + e]] + push.origin;
    ends[e] = push.toClip * vec4(places[e], 1);
  }
  // Points nearer than the near plane, or behind the eye, have no place in the picture.
  for (uint e = 0; e < 2; ++e) {
    if (ends[e].z >= 0 || ends[1 - e].z <= 0) continue;
    const float share = ends[e].z / (ends[e].z - ends[1 - e].z);
    places[e] = mix(places[e], places[1 - e], share);
    ends[e] = mix(ends[e], ends[1 - e], share);
  }
  const vec2 size = pictureSize();
  const vec2 way = (ends[1].xy / ends[1].w - ends[0].xy / ends[0].w) * size;
  const vec2 along = length(way) > 0 ? normalize(way) : vec2(1, 0);
  const uint end = corner == 2 || corner == 3 || corner == 5 ? 1 : 0;
  const float side = corner == 1 || corner == 4 || corner == 5 ? 1 : -1;
  const vec2 off = (end == 1 ? 1 : -1) * along + side * vec2(-along.y, along.x);
  place = places[end];
  gl_Position = ends[end];
  gl_Position.xy += 2 * kHalfWidth * off / size * ends[end].w;
}
