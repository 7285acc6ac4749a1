// Declarations shared by the kernels of the harmonic solve.

#include "method/winding_harmonic_shared.h"
#include "method/winding_rims_shared.h"
#include "vulkan/stages/winding_harmonic_push.h"
#include "vulkan/stages/ray_map.glsl"

// Whether the lattices are those on which numbers follow from rims.
layout(constant_id = 2) const uint kHasRims = 0;
layout(push_constant, scalar) uniform Push { WindingHarmonicPush push; };

ivec3 gridDims() {
  return ivec3(push.gridX, push.gridY, push.gridZ);
}

ivec3 boxDims(uint level) {
  return kHasRims != 0 ? rimDims(gridDims(), level) : harmonicDims(gridDims(), level);
}

int boxLow(uint level) {
  return kHasRims != 0 ? 0 : harmonicLow(level);
}

// Returns the index of this work group among those of all dispatches of a kernel.
uint wholeGroupIndex() {
  return push.firstGroup + groupIndex();
}

uint wholeInvocationIndex() {
  return push.firstGroup * gl_WorkGroupSize.x + invocationIndex();
}

uint sampleCount(ivec3 dims) {
  return uint(dims.x) * uint(dims.y) * uint(dims.z);
}

uint indexOf(ivec3 s, ivec3 dims) {
  return uint((s.z * dims.y + s.y) * dims.x + s.x);
}

ivec3 sampleAt(uint index, ivec3 dims) {
  const uint row = index / uint(dims.x);
  return ivec3(index % uint(dims.x), row % uint(dims.y), row / uint(dims.y));
}

bool isInner(ivec3 s, ivec3 dims) {
  return all(greaterThan(s, ivec3(0))) && all(lessThan(s, dims - 1));
}

// Returns the sum of the amounts by which w at a sample should exceed its two neighbours along an axis (Eq.
// 5). An edge of the lattice is a chain of the grid's edges, and its count is the sum of theirs.
int jumpAlong(Ints rays, uint axis, ivec3 s) {
  const ivec3 dims = gridDims();
  const ivec3 at = (s + boxLow(push.level)) << int(push.level);
  ivec3 across = at;
  across[axis] = 0;
  if (any(lessThan(across, ivec3(0))) || any(greaterThanEqual(across, dims))) return 0;
  ivec3 before = at, after = at;
  before[axis] -= 1 << push.level;
  after[axis] += 1 << push.level;
  return 2 * rayFrom(rays, axis, dims, at) - rayFrom(rays, axis, dims, before) - rayFrom(rays, axis, dims, after);
}

int sumJumps(ivec3 s) {
  return jumpAlong(push.rays[0], 0, s) + jumpAlong(push.rays[1], 1, s) + jumpAlong(push.rays[2], 2, s);
}

float rightHandSide(ivec3 s, ivec3 dims) {
  if (uint64_t(push.rightHandSide) != 0) return push.rightHandSide.at[indexOf(s, dims)];
  return float(sumJumps(s));
}

// Returns six times the value of an inner sample that its neighbours and the right-hand side require.
float asked(ivec3 s, ivec3 dims) {
  const uint i = indexOf(s, dims);
  const uint row = uint(dims.x), plane = row * uint(dims.y);
  const float alongX = push.values.at[i - 1] + push.values.at[i + 1];
  const float alongY = push.values.at[i - row] + push.values.at[i + row];
  const float alongZ = push.values.at[i - plane] + push.values.at[i + plane];
  return (alongX + alongY) + (alongZ + rightHandSide(s, dims));
}

// Returns the place of the sample of the next coarser lattice at or before a sample.
ivec3 coarseBelow(ivec3 s) {
  return (s >> 1) + boxLow(push.level) / 2 - boxLow(push.level + 1);
}

float coarseAt(ivec3 s, ivec3 dims) {
  return push.coarse.at[indexOf(s, dims)];
}
