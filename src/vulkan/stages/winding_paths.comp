// Adds the curves by way of some offset points to each sample's sum.
#include "vulkan/device/kernel.glsl"
#include "method/winding_paths_shared.h"
#include "vulkan/primitives/rounded_division.glsl"
#include "vulkan/stages/ray_map.glsl"
#include "vulkan/stages/sixth.glsl"
#include "vulkan/stages/winding_paths_push.h"

layout(constant_id = 1) const uint kReadsRaysOutside = 0;
layout(push_constant, scalar) uniform Push { WindingPathsPush push; };

#define OFFSET(point) ivec3(push.offsets[3 * point], push.offsets[3 * point + 1], push.offsets[3 * point + 2])

bool isInside(ivec3 s, ivec3 dims) {
  return all(greaterThanEqual(s, ivec3(0))) && all(lessThan(s, dims));
}

// Push constants are read at constant places only (see addCrossing in crossings.glsl).
ivec3 offsetTo(uint point) {
  const ivec3 low = point == 0 ? OFFSET(0) : OFFSET(1), high = point == 2 ? OFFSET(2) : OFFSET(3);
  return point < 2 ? low : high;
}

// Eq. 7: a ray beside the grid's lines meets nothing.
int ray(Ints rays, uint axis, ivec3 s, ivec3 dims) {
  ivec3 across = s;
  across[axis] = 0;
  return isInside(across, dims) ? rayFrom(rays, axis, dims, s) : 0;
}

// Returns what a ray along an axis meets from a point outside the grid. From beyond the line it takes the other
// way.
int rayOutside(Ints rays, uint axis, ivec3 s, ivec3 dims) {
  ivec3 before = s;
  before[axis] = -1;
  const int total = ray(rays, axis, before, dims);
  return s[axis] < 0 ? total : -total;
}

// Returns the mean of the six rays of a point outside the grid. Only a ray along a line of the grid meets anything,
// so at most one of the three terms is not 0.
float meanRayOutside(ivec3 s, ivec3 dims) {
  return sixth(rayOutside(push.rays[0], 0, s, dims) + rayOutside(push.rays[1], 1, s, dims) +
               rayOutside(push.rays[2], 2, s, dims));
}

// Paper: offset points outside the grid get six rays, too. Here: they get 0 unless asked for, because no
// surface lies there.
float valueAt(ivec3 s, ivec3 dims) {
  if (isInside(s, dims)) return push.values.at[indexOf(uvec3(s), push.dims)];
  return kReadsRaysOutside != 0 ? meanRayOutside(s, dims) : 0.0;
}

// Returns the sum of the signed crossings of the paths' edges along an axis.
int countEdges(Ints rays, uint axis, ivec3 s, ivec3 offset, ivec3 dims) {
  const uint u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  int count = 0;
  [[unroll]] for (uint side = 0; side < 4; ++side) {
    // Edge after or before the steps along u and v. It belongs to two of the six paths if it comes first or
    // last, and to one if it comes second.
    ivec3 from = s;
    if ((side & 1) != 0) from[u] += offset[u];
    if ((side & 2) != 0) from[v] += offset[v];
    ivec3 to = from;
    to[axis] += offset[axis];
    const int paths = side == 0 || side == 3 ? 2 : 1;
    count += paths * (ray(rays, axis, from, dims) - ray(rays, axis, to, dims));  // Eq. 6.
  }
  return count;
}

// Returns the sum of the signed crossings of the six paths from a sample to its offset point.
int countPaths(ivec3 s, ivec3 offset, ivec3 dims) {
  return countEdges(push.rays[0], 0, s, offset, dims) + countEdges(push.rays[1], 1, s, offset, dims) +
         countEdges(push.rays[2], 2, s, offset, dims);
}

void main() {
  const uint index = push.firstGroup * gl_WorkGroupSize.x + invocationIndex();
  const ivec3 dims = ivec3(push.dims);
  const ivec3 s = ivec3(placeOf(index, push.dims));
  if (s.z >= dims.z) return;
  precise float sum = push.sumScale * push.sums.at[index];
  for (uint point = 0; point < push.pointCount; ++point) {
    const ivec3 offset = offsetTo(point);
    const float there = valueAt(s + offset, dims);
    sum += push.pointScale * (float(countPaths(s, offset, dims)) + float(kPathsPerPoint) * there);
  }
  push.result.at[index] = divideRounded(sum, push.divisor);
}
