// From a lattice of the harmonic solve to the next coarser one, and back.

// Each kernel says where the coarser lattice's values and the residuals of this one lie.
float coarseAt(ivec3 s, ivec3 coarse);
float residualAt(uint i);

// Returns how many coarser samples lie before the one at this lattice's first sample.
int coarseBefore() {
  return boxLow(push.level) / 2 - boxLow(push.level + 1);
}

// Returns the place of the sample of the next coarser lattice at or before a sample.
ivec3 coarseBelow(ivec3 s) {
  return (s >> 1) + coarseBefore();
}

float halfJump(Ints rays, uint axis, ivec3 s) {
  return 0.5 * float(jumpAlong(rays, axis, s, push.level));
}

// Returns the value in a row with even y and z, which may lie just beyond the box.
float prolongedX(ivec3 s, ivec3 dims, ivec3 coarse) {
  const ivec3 low = coarseBelow(s);
  if ((s.x & 1) == 0) return coarseAt(low, coarse);
  const float mean = 0.5 * (coarseAt(low, coarse) + coarseAt(low + ivec3(1, 0, 0), coarse));
  return s.y < dims.y && s.z < dims.z ? mean + halfJump(push.rays[0], 0, s) : mean;
}

// Returns the value in a plane with even z, which may lie just beyond the box.
float prolongedXY(ivec3 s, ivec3 dims, ivec3 coarse) {
  if ((s.y & 1) == 0) return prolongedX(s, dims, coarse);
  const float mean = 0.5 * (prolongedX(s - ivec3(0, 1, 0), dims, coarse) + prolongedX(s + ivec3(0, 1, 0), dims, coarse));
  return s.z < dims.z ? mean + halfJump(push.rays[1], 1, s) : mean;
}

// Returns the value of a sample that follows from the coarser lattice. A sample between two coarser ones is the mean
// of the values that both require over the lattice edges between. The field thus keeps its jumps where the crossings
// are.
float prolonged(ivec3 s, ivec3 dims, ivec3 coarse) {
  const float value = prolongedXY(s - ivec3(0, 0, s.z & 1), dims, coarse);
  if ((s.z & 1) == 0) return value;
  return 0.5 * (value + prolongedXY(s + ivec3(0, 0, 1), dims, coarse)) + halfJump(push.rays[2], 2, s);
}

// Returns the correction of a sample: smooth, linear between the coarser samples.
float correctionOf(ivec3 s, ivec3 coarse) {
  const ivec3 low = coarseBelow(s), high = low + (s & 1);
  const float near = 0.5 * (0.5 * (coarseAt(low, coarse) + coarseAt(ivec3(high.x, low.yz), coarse)) +
                            0.5 * (coarseAt(ivec3(low.x, high.y, low.z), coarse) + coarseAt(ivec3(high.xy, low.z), coarse)));
  const float far = 0.5 * (0.5 * (coarseAt(ivec3(low.xy, high.z), coarse) + coarseAt(ivec3(high.x, low.y, high.z), coarse)) +
                           0.5 * (coarseAt(ivec3(low.x, high.yz), coarse) + coarseAt(high, coarse)));
  return 0.5 * (near + far);
}

float restrictedX(uint i, uvec3 before, uvec3 after) {
  return 0.5 * residualAt(i) + 0.25 * (residualAt(i - before.x) + residualAt(i + after.x));
}

float restrictedXY(uint i, uvec3 before, uvec3 after) {
  return 0.5 * restrictedX(i, before, after) +
         0.25 * (restrictedX(i - before.y, before, after) + restrictedX(i + after.y, before, after));
}

// Returns the weighted residual around a sample, in the units of the coarser equations, whose cells are twice as wide.
// `before` and `after` are the distances to the places of its neighbours along each axis.
float restricted(uint i, uvec3 before, uvec3 after) {
  return 2.0 * restrictedXY(i, before, after) +
         (restrictedXY(i - before.z, before, after) + restrictedXY(i + after.z, before, after));
}
