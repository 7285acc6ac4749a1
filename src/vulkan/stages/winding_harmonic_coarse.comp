// Solves the two coarsest lattices in one work group: from the jumps, or as the rest of a V-cycle, whose samples of
// the first colour are relaxed already.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_harmonic.glsl"
#include "vulkan/stages/winding_harmonic_transfer.glsl"

layout(constant_id = 1) const uint kSweeps = 1;

// Memory that one invocation writes and another one reads. All else is read by the invocation that wrote it.
layout(buffer_reference, scalar, buffer_reference_align = 4) coherent buffer SharedFloats { float at[]; };

shared float field[kMostCoarsest * kMostCoarsest * kMostCoarsest];  // The coarsest lattice's.

// The pairs of a lattice's samples that an invocation works on.
struct Pairs {
  ivec3 dims, first, step;
};

Pairs pairsOf(ivec3 lattice) {
  const ivec3 dims = pairDims(lattice);
  return Pairs(dims, sampleAt(gl_LocalInvocationIndex, dims), sampleAt(gl_WorkGroupSize.x, dims));
}

ivec3 nextPair(ivec3 pair, Pairs pairs) {
  pair += pairs.step;
  if (pair.x >= pairs.dims.x) pair += ivec3(-pairs.dims.x, 1, 0);
  if (pair.y >= pairs.dims.y) pair += ivec3(0, -pairs.dims.y, 1);
  return pair;
}

float valueAt(uint i) {
  return SharedFloats(push.values).at[i];
}

float coarseAt(ivec3 s, ivec3 coarse) {
  return field[indexOf(s, coarse)];
}

float residualAt(uint i) {
  return SharedFloats(push.coarse).at[i];
}

// Returns what the residuals require of a coarser sample. Beyond the lattice they are zero, as on its rim.
float restrictedTo(ivec3 coarser, ivec3 dims) {
  const ivec3 s = 2 * (coarser - coarseBefore());
  if (any(lessThan(s, ivec3(0))) || any(greaterThanEqual(s, dims))) return 0.0;
  const uvec3 strides = uvec3(1, dims.x, dims.x * dims.y);
  return restricted(indexOf(s, dims), strides * uvec3(greaterThan(s, ivec3(0))), strides * uvec3(lessThan(s, dims - 1)));
}

// Makes the group's writes visible to all of it.
void meet() {
  memoryBarrierBuffer();
  barrier();
}

void storeJumps(Pairs pairs, ivec3 dims, Floats to, uint level) {
  for (ivec3 pair = pairs.first; pair.z < pairs.dims.z; pair = nextPair(pair, pairs))
    for (uint colour = 0; colour < 2; ++colour) {
      const ivec3 s = sampleOfPair(pair, colour);
      if (s.x < dims.x) to.at[indexOf(s, dims)] = sumJumps(s, level);
    }
}

void relax(Pairs pairs, ivec3 dims, uint colour) {
  for (ivec3 pair = pairs.first; pair.z < pairs.dims.z; pair = nextPair(pair, pairs)) {
    const ivec3 s = sampleOfPair(pair, colour);
    if (isInner(s, dims)) SharedFloats(push.values).at[indexOf(s, dims)] = asked(s, dims) * (1.0 / 6.0);
  }
  meet();
}

void restrictResidual(Pairs pairs, ivec3 dims, Pairs coarsePairs, ivec3 coarse) {
  for (ivec3 pair = pairs.first; pair.z < pairs.dims.z; pair = nextPair(pair, pairs))
    for (uint colour = 0; colour < 2; ++colour) {
      const ivec3 s = sampleOfPair(pair, colour);
      if (s.x < dims.x) SharedFloats(push.coarse).at[indexOf(s, dims)] = residualOf(s, dims);
    }
  meet();
  for (ivec3 pair = coarsePairs.first; pair.z < coarsePairs.dims.z; pair = nextPair(pair, coarsePairs))
    for (uint colour = 0; colour < 2; ++colour) {
      const ivec3 s = sampleOfPair(pair, colour);
      if (s.x < coarse.x) push.coarseEquations.at[indexOf(s, coarse)] = restrictedTo(s, dims);
    }
}

// Most pairs of the coarsest lattice that an invocation works on.
const uint kMostOwn = ((kMostCoarsest + 1) / 2 * kMostCoarsest * kMostCoarsest + gl_WorkGroupSize.x - 1) / gl_WorkGroupSize.x;

// Solves the coarsest lattice, starting from zero, by over-relaxation (Young 1954).
void solveCoarsest(Pairs pairs, ivec3 dims) {
  for (uint i = gl_LocalInvocationIndex; i < countOf(uvec3(dims)); i += gl_WorkGroupSize.x) field[i] = 0.0;
  uint places[2 * kMostOwn];  // Of the inner samples, those of the first colour first; 0: none.
  float asked[2 * kMostOwn];
  ivec3 pair = pairs.first;
  [[unroll]] for (uint own = 0; own < kMostOwn; ++own, pair = nextPair(pair, pairs))
    [[unroll]] for (uint colour = 0; colour < 2; ++colour) {
      const ivec3 s = sampleOfPair(pair, colour);
      places[2 * own + colour] = isInner(s, dims) ? indexOf(s, dims) : 0;
      if (isInner(s, dims)) asked[2 * own + colour] = push.coarseEquations.at[indexOf(s, dims)];
    }
  barrier();
  const uint row = uint(dims.x), plane = row * uint(dims.y);
  for (uint sweep = 0; sweep < kSweeps; ++sweep)
    [[unroll]] for (uint colour = 0; colour < 2; ++colour) {
      [[unroll]] for (uint own = 0; own < kMostOwn; ++own) {
        const uint i = places[2 * own + colour];
        if (i == 0) continue;
        const float sum = (field[i - 1] + field[i + 1]) + (field[i - row] + field[i + row]) +
                          ((field[i - plane] + field[i + plane]) + asked[2 * own + colour]);
        field[i] += push.factor * (sum * (1.0 / 6.0) - field[i]);
      }
      barrier();
    }
}

void prolong(Pairs pairs, ivec3 dims, ivec3 coarse) {
  for (ivec3 pair = pairs.first; pair.z < pairs.dims.z; pair = nextPair(pair, pairs))
    for (uint colour = 0; colour < 2; ++colour) {
      const ivec3 s = sampleOfPair(pair, colour);
      if (s.x < dims.x) SharedFloats(push.values).at[indexOf(s, dims)] = prolonged(s, dims, coarse);
    }
  meet();
}

void correct(Pairs pairs, ivec3 dims, ivec3 coarse) {
  for (ivec3 pair = pairs.first; pair.z < pairs.dims.z; pair = nextPair(pair, pairs))
    for (uint colour = 0; colour < 2; ++colour) {
      const ivec3 s = sampleOfPair(pair, colour);
      if (s.x < dims.x) SharedFloats(push.values).at[indexOf(s, dims)] += correctionOf(s, coarse);
    }
  meet();
}

void main() {
  if (groupIndex() > 0) return;
  const ivec3 dims = boxDims(push.level), coarse = boxDims(push.level + 1);
  const Pairs pairs = pairsOf(dims), coarsePairs = pairsOf(coarse);
  if (push.colour == 0) {
    storeJumps(pairs, dims, push.rightHandSide, push.level);
    storeJumps(coarsePairs, coarse, push.coarseEquations, push.level + 1);
    solveCoarsest(coarsePairs, coarse);
    prolong(pairs, dims, coarse);
    relax(pairs, dims, 0);
  }
  relax(pairs, dims, 1);
  restrictResidual(pairs, dims, coarsePairs, coarse);
  solveCoarsest(coarsePairs, coarse);
  correct(pairs, dims, coarse);
  relax(pairs, dims, 0);
  relax(pairs, dims, 1);
}
