// Declarations shared by the kernels of the harmonic solve.

#include "method/winding_harmonic_shared.h"
#include "method/winding_rims_shared.h"
#include "vulkan/stages/winding_harmonic_push.h"
#include "vulkan/stages/ray_map.glsl"

// Whether the lattices are those on which numbers follow from rims.
layout(constant_id = 2) const uint kHasRims = 0;
// Whether a right-hand side is stored; else it is where its address is not 0.
layout(constant_id = 3) const uint kHasEquations = 0;
layout(push_constant, scalar) uniform Push { WindingHarmonicPush push; };

ivec3 gridDims() {
  return ivec3(push.dims);
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

uint indexOf(ivec3 s, ivec3 dims) {
  return indexOf(uvec3(s), uvec3(dims));
}

ivec3 sampleAt(uint index, ivec3 dims) {
  return ivec3(placeOf(index, uvec3(dims)));
}

bool isInner(ivec3 s, ivec3 dims) {
  return all(greaterThan(s, ivec3(0))) && all(lessThan(s, dims - 1));
}

ivec3 pairDims(ivec3 dims) {
  return ivec3((dims.x + 1) / 2, dims.yz);
}

// Returns the sample of one of the two colours, which alternate along each axis, in a pair of samples along x. The last
// pair may reach beyond the lattice.
ivec3 sampleOfPair(ivec3 pair, uint colour) {
  return ivec3(2 * pair.x + ((pair.y + pair.z + int(colour) + 1) & 1), pair.yz);
}

bool isFirstColour(ivec3 s) {
  return ((s.x + s.y + s.z) & 1) == 1;
}

// Returns the sum of the amounts by which w at a sample should exceed its two neighbours along an axis (Eq.
// 5). An edge of the lattice is a chain of the grid's edges, and its count is the sum of theirs.
int jumpAlong(Ints rays, uint axis, ivec3 s, uint level) {
  const ivec3 dims = gridDims();
  const ivec3 at = (s + boxLow(level)) << int(level);
  ivec3 across = at;
  across[axis] = 0;
  if (any(lessThan(across, ivec3(0))) || any(greaterThanEqual(across, dims))) return 0;
  ivec3 before = at, after = at;
  before[axis] -= 1 << level;
  after[axis] += 1 << level;
  return 2 * rayFrom(rays, axis, dims, at) - rayFrom(rays, axis, dims, before) - rayFrom(rays, axis, dims, after);
}

float sumJumps(ivec3 s, uint level) {
  return float(jumpAlong(push.rays[0], 0, s, level) + jumpAlong(push.rays[1], 1, s, level) +
               jumpAlong(push.rays[2], 2, s, level));
}

float rightHandSide(ivec3 s, ivec3 dims) {
  if (kHasEquations != 0 || uint64_t(push.rightHandSide) != 0) return push.rightHandSide.at[indexOf(s, dims)];
  return sumJumps(s, push.level);
}

// Each kernel says where values lie.
float valueAt(uint i);

// Returns six times the value of an inner sample that its neighbours and the right-hand side require.
float asked(ivec3 s, ivec3 dims) {
  const uint i = indexOf(s, dims);
  const uint row = uint(dims.x), plane = row * uint(dims.y);
  const float alongX = valueAt(i - 1) + valueAt(i + 1);
  const float alongY = valueAt(i - row) + valueAt(i + row);
  const float alongZ = valueAt(i - plane) + valueAt(i + plane);
  return (alongX + alongY) + (alongZ + rightHandSide(s, dims));
}

// Returns the residual of a sample, whose values must not change meanwhile: zero on the lattice's rim.
float residualOf(ivec3 s, ivec3 dims) {
  return isInner(s, dims) ? asked(s, dims) - 6.0 * valueAt(indexOf(s, dims)) : 0.0;
}
