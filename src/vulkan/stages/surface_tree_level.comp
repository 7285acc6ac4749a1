// Computes discs around the discs of each node's children.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/surface_tree.glsl"
#include "vulkan/stages/surface_shapes.glsl"

Disc boundDiscs(uint first, uint count) {
  vec3 low = vec3(kLargestFloat), high = -low, normal = vec3(0);
  for (uint child = first; child < first + count; ++child) {
    const Disc disc = readDisc(push.discs, child);
    low = min(low, disc.centre);
    high = max(high, disc.centre);
    normal += disc.normal * (disc.radius * disc.radius);
  }
  normal = unitVector(normal);
  const vec3 middle = 0.5 * (low + high);
  // Extents of the discs along and across the common normal.
  float front = -kLargestFloat, back = -front, radius = 0, reach = 0;
  for (uint child = first; child < first + count; ++child) {
    const Disc disc = readDisc(push.discs, child);
    const vec3 q = disc.centre - middle;
    const float height = dot(q, normal);
    // The sine from the cross product: from the cosine of a small angle it would be rounding error only.
    const vec3 turn = cross(disc.normal, normal);
    const float cosine = abs(dot(disc.normal, normal)), sine = root(dot(turn, turn));
    const float along = disc.radius * sine + disc.halfThickness * cosine;
    const float size = root(disc.radius * disc.radius + disc.halfThickness * disc.halfThickness);
    const float across = min(disc.radius + disc.halfThickness * sine, size);
    front = max(front, height + along);
    back = min(back, height - along);
    radius = max(radius, lengthAcross(q, height) + across);
    reach = max(reach, root(dot(q, q)) + size);
  }
  return outwards(Disc(middle + 0.5 * (front + back) * normal, normal, radius, 0.5 * (front - back)), reach);
}

void main() {
  const uint node = invocationIndex();
  if (node >= levelPlaces()) return;
  const uint first = node * kTreeArity, index = push.levelStart + node;
  writeDisc(push.discs, index,
            node < push.levelCount ? boundDiscs(index * kTreeArity + 1, min(kTreeArity, push.levelBelowCount - first))
                                   : discOutOfReach());
}
