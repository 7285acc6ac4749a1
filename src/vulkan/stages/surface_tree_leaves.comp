// Gives each triangle a frame of its own, and each leaf a disc around its eight triangles.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/surface_tree.glsl"
#include "vulkan/stages/surface_shapes.glsl"
#include "vulkan/stages/surface_frames.glsl"

layout(constant_id = 1) const uint kLeaves = 1;  // Leaves per group.

shared vec3 corners[kLeaves * kTreeArity * 3];

Disc boundCorners(uint first) {
  vec3 low = vec3(kLargestFloat), high = -low, normal = vec3(0);
  for (uint i = first; i < first + 3 * kTreeArity; i += 3) {
    const vec3 a = corners[i], b = corners[i + 1], c = corners[i + 2];
    low = min(min(low, a), min(b, c));
    high = max(max(high, a), max(b, c));
    normal += cross(b - a, c - a);
  }
  normal = unitVector(normal);
  const vec3 middle = 0.5 * (low + high);
  float front = -kLargestFloat, back = -front, radius = 0, reach = 0;
  for (uint i = first; i < first + 3 * kTreeArity; ++i) {
    const vec3 q = corners[i] - middle;
    const float height = dot(q, normal);
    front = max(front, height);
    back = min(back, height);
    radius = max(radius, lengthAcross(q, height));
    reach = max(reach, root(dot(q, q)));
  }
  return outwards(Disc(middle + 0.5 * (front + back) * normal, normal, radius, 0.5 * (front - back)), reach);
}

void main() {
  const uint place = invocationIndex(), leaf = groupIndex() * kLeaves + gl_LocalInvocationID.x;
  if (place / kTreeArity < push.levelCount) {
    // The last triangle fills up the last leaf.
    const uint triangle = push.order.at[min(place, push.triangleCount - 1)];
    const vec3 p = readCorner(triangle, 0), q = readCorner(triangle, 1), r = readCorner(triangle, 2);
    writeTriangle(push.frames, place, makeFrame(p, q, r), triangle);
    corners[3 * gl_LocalInvocationID.x] = p;
    corners[3 * gl_LocalInvocationID.x + 1] = q;
    corners[3 * gl_LocalInvocationID.x + 2] = r;
  }
  barrier();
  if (gl_LocalInvocationID.x >= kLeaves || leaf >= placesOf(push.levelStart, push.levelCount)) return;
  writeDisc(push.discs, push.levelStart + leaf,
            leaf < push.levelCount ? boundCorners(3 * kTreeArity * gl_LocalInvocationID.x) : discOutOfReach());
}
