// Krayer & Müller 2019, §4, end: finds the lattice edges at which the sign changes but no triangle crosses.
// GPU twin of cpu/sign/close_holes.cpp.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/crossed_edges.glsl"
#include "vulkan/stages/close_holes_push.h"

layout(push_constant, scalar) uniform Push { CloseHolesPush push; };

ivec3 dims() {
  return ivec3(push.dims);
}

float windingAt(ivec3 s) {
  return push.winding.at[indexOf(uvec3(s), push.dims)];
}

bool isInside(ivec3 s) {
  return abs(windingAt(s)) > push.threshold;
}

ivec3 nextAlong(uint axis, ivec3 s) {
  s[axis] += 1;
  return s;
}

// Returns whether triangles cross the edge from a sample to the next one; edge e of a line leads to sample e.
bool isCrossed(uint axis, ivec3 s) {
  const ivec3 size = nextAlong(axis, dims()), place = nextAlong(axis, s);
  return isCrossed(push.crossed, push.crossedWords, axis, indexOf(uvec3(place), uvec3(size)));
}

ivec3 cubeAround(ivec3 s, uint axis, uint c) {
  ivec3 cube = nextAlong(axis, s);
  cube[(axis + 1) % 3] += int(c == 1 || c == 2);
  cube[(axis + 2) % 3] += int(c >= 2);
  return cube;
}

// Returns whether triangles cross an edge of the cube at which the sign changes; false for cubes that reach
// beyond the grid.
bool hasCrossedChange(ivec3 cube) {
  if (any(equal(cube, ivec3(0))) || any(equal(cube, dims()))) return false;
  for (uint axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner) {
      ivec3 low = cube - 1;
      low[(axis + 1) % 3] += corner & 1;
      low[(axis + 2) % 3] += corner >> 1;
      if (isInside(low) != isInside(nextAlong(axis, low)) && isCrossed(axis, low)) return true;
    }
  return false;
}

void addMissing(uint sampleIndex, ivec3 s, uint axis) {
  const uint place = atomicAdd(push.count.at[0], 1);
  if (place >= push.room) return;
  uint rimCubes = 0;
  for (uint c = 0; c < kCubesAround; ++c) rimCubes |= uint(hasCrossedChange(cubeAround(s, axis, c))) << c;
  push.edges.at[place] =
      MissingEdge(sampleIndex, axis, rimCubes, float[2](windingAt(s), windingAt(nextAlong(axis, s))));
}

void main() {
  const uint i = invocationIndex();
  if (i >= countOf(push.dims)) return;
  const ivec3 s = ivec3(placeOf(i, push.dims));
  for (uint axis = 0; axis < 3; ++axis) {
    if (s[axis] + 1 == dims()[axis] || isInside(s) == isInside(nextAlong(axis, s))) continue;
    if (!isCrossed(axis, s)) addMissing(i, s, axis);
  }
}
