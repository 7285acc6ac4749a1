// How badly the field fits the crossings (src/cpu/orientation.cpp): each group adds up its samples, always in the same
// order.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel.glsl"
#include "orientation.glsl"

shared float squaresOf[kMisfitGroup];
shared float jumpsOf[kMisfitGroup];

void addEdge(uint index, ivec3 s, uint axis, uint stride, inout float squares, inout float jumps) {
  const ivec3 dims = gridDims();
  if (s[axis] + 1 >= dims[axis]) return;
  ivec3 next = s;
  next[axis] += 1;
  const int jump = rayFrom(push.rays[axis], axis, dims, s) - rayFrom(push.rays[axis], axis, dims, next);
  if (jump == 0) return;
  squares += float(jump) * (float(jump) - (push.field.at[index] - push.field.at[index + stride]));
  jumps += abs(float(jump));
}

void main() {
  const uint lane = gl_LocalInvocationIndex;
  float squares = 0.0, jumps = 0.0;
  for (uint n = 0; n < kMisfitSamples; ++n) {
    const uint index = (groupIndex() * kMisfitSamples + n) * kMisfitGroup + lane;
    if (index >= sampleCount()) break;
    const ivec3 s = sampleAt(index);
    addEdge(index, s, 0, 1, squares, jumps);
    addEdge(index, s, 1, push.gridX, squares, jumps);
    addEdge(index, s, 2, push.gridX * push.gridY, squares, jumps);
  }
  squaresOf[lane] = squares;
  jumpsOf[lane] = jumps;
  for (uint reach = kMisfitGroup / 2; reach > 0; reach /= 2) {
    barrier();
    if (lane >= reach) continue;
    squaresOf[lane] += squaresOf[lane + reach];
    jumpsOf[lane] += jumpsOf[lane + reach];
  }
  if (lane != 0 || uint64_t(groupIndex()) * kMisfitGroup * kMisfitSamples >= sampleCount()) return;
  push.misfit.at[2 * groupIndex()] = squaresOf[0];
  push.misfit.at[2 * groupIndex() + 1] = jumpsOf[0];
}
