// Computes the average of the six rays of each sample, or takes the one along +x.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/sixth.glsl"
#include "vulkan/stages/winding_rays_push.h"

layout(constant_id = 1) const uint kIsOneRay = 0;
layout(push_constant, scalar) uniform Push { WindingRaysPush push; };

shared uint doubtfulOfGroup;

// Eq. 7: along each axis r is the ray to plus infinity, and r minus the line's total the ray to minus
// infinity. With our sign, leaving through a face is +1 both ways. Counts the sample if its rays
// disagree.
float windingOf(uint index, inout uint doubtful) {
  const uint nx = push.dims.x, ny = push.dims.y;
  const uint i = index % nx, row = index / nx, k = row / ny;
  const int x = push.rays[0].at[row * (nx + 1) + i + 1], totalX = push.rays[0].at[row * (nx + 1)];
  const int y = push.rays[1].at[index + (k + 1) * nx], totalY = push.rays[1].at[k * (ny + 1) * nx + i];
  const int z = push.rays[2].at[index + nx * ny], totalZ = push.rays[2].at[index - k * nx * ny];
  doubtful += uint(((x ^ y) | (y ^ z) | totalX | totalY | totalZ) != 0);
  if (kIsOneRay != 0) return float(x);
  return sixth(2 * (x + y + z) - (totalX + totalY + totalZ));
}

uint sampleIndex(uint row) {
  return (groupIndex() * kWindingRaysRows + row) * gl_WorkGroupSize.x + gl_LocalInvocationIndex;
}

void main() {
  if (gl_LocalInvocationIndex == 0) doubtfulOfGroup = 0;
  barrier();
  uint doubtful = 0;
  float winding[kWindingRaysRows];
  // All reads precede all writes, so that they can overlap.
  [[unroll]] for (uint row = 0; row < kWindingRaysRows; ++row)
    if (sampleIndex(row) < push.sampleCount) winding[row] = windingOf(sampleIndex(row), doubtful);
  [[unroll]] for (uint row = 0; row < kWindingRaysRows; ++row)
    if (sampleIndex(row) < push.sampleCount) push.winding.at[sampleIndex(row)] = winding[row];
  doubtful = subgroupAdd(doubtful);
  if (subgroupElect() && doubtful > 0) atomicAdd(doubtfulOfGroup, doubtful);
  barrier();
  if (gl_LocalInvocationIndex == 0 && doubtfulOfGroup > 0) atomicAdd(push.doubtful.at[0], doubtfulOfGroup);
}
