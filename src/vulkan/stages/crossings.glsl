// Declarations shared by all kernels of the crossings: triangles on the lattice of 2^-bits cells, as in
// cpu/sign/crossings.cpp.

#include "method/crossings_shared.h"
#include "vulkan/stages/crossed_edges.glsl"
#include "vulkan/stages/crossings_push.h"

layout(push_constant, scalar) uniform Push { CrossingsPush push; };

struct SnappedTriangle {
  i64vec3 a, b, c;
  ivec3 begin, end;  // Lines across each axis that its bounding box covers.
};

vec3 cornerOf(uint triangle, uint corner) {
  return vectorAt(push.vertices, push.triangles.at[3 * triangle + corner]);
}

int exponentOf(uint bits) {
  return int(bits >> 23) - 127;
}

bool isTooFar() {
  return exponentOf(push.status.now.reach) >= kCoordinateBits;
}

int fractionBits() {
  return clamp(kCoordinateBits - 1 - max(exponentOf(push.status.now.reach), 0), 0, kMaxFractionBits);
}

// Exact: the float times a power of two, rounded to the nearest integer, halves away from 0.
int64_t snap(float x, int bits) {
  const uint size = floatBitsToUint(x) & 0x7fffffffu;
  const int64_t mantissa = int64_t((size & 0x7fffffu) | 0x800000u);
  const int shift = exponentOf(size) - 23 + bits;
  int64_t snapped = 0;
  if (shift >= 0)
    snapped = mantissa << shift;
  else if (shift >= -24)
    snapped = (mantissa + (1l << (-shift - 1))) >> -shift;
  return x < 0.0 ? -snapped : snapped;
}

i64vec3 snap(vec3 p, int bits) {
  return i64vec3(snap(p.x, bits), snap(p.y, bits), snap(p.z, bits));
}

ivec3 lineFrom(i64vec3 coordinate, int bits) {
  const i64vec3 line = (coordinate + ((1l << bits) - 1)) >> int64_t(bits);
  return ivec3(clamp(line, i64vec3(0), i64vec3(push.dims)));
}

SnappedTriangle snapTriangle(uint triangle, int bits) {
  SnappedTriangle t;
  t.a = snap(cornerOf(triangle, 0), bits);
  t.b = snap(cornerOf(triangle, 1), bits);
  t.c = snap(cornerOf(triangle, 2), bits);
  t.begin = lineFrom(min(min(t.a, t.b), t.c), bits);
  t.end = lineFrom(max(max(t.a, t.b), t.c), bits);
  return t;
}

// Return vectors in the frame (u, v, axis) of a lattice line; u is the lower of the two axes across it.
i64vec3 inFrame(i64vec3 p, uint axis) {
  return axis == 0 ? p.yzx : axis == 1 ? p.xzy : p;
}

ivec3 inFrame(ivec3 p, uint axis) {
  return axis == 0 ? p.yzx : axis == 1 ? p.xzy : p;
}

ivec3 fromFrame(ivec3 p, uint axis) {
  return axis == 0 ? p.zxy : axis == 1 ? p.xzy : p;
}

// Returns the lines along the axis that the triangle's bounding box covers: lines per row, number of rows.
uvec2 linesAlong(SnappedTriangle t, uint axis) {
  const ivec3 size = inFrame(t.end - t.begin, axis);
  return size.x > 0 && size.y > 0 ? uvec2(size.xy) : uvec2(0);
}

void addCrossing(uint axis, ivec3 at, int direction) {
  const uint edge = indexOf(uvec3(fromFrame(at, axis)), push.dims + uvec3(axis == 0, axis == 1, 0));
  // Invocations of a subgroup may have different axes, and an index into push constants must be the same for all of
  // them: AMD's compiler takes the first one's.
  if (axis == 0) atomicAdd(push.lines[0].at[edge], direction);
  if (axis == 1) atomicAdd(push.lines[1].at[edge], direction);
  if (axis == 2) atomicAdd(push.lines[2].at[edge], direction);
  if (uint64_t(push.crossed) != 0) markCrossed(push.crossed, push.crossedWords, axis, edge);
}
