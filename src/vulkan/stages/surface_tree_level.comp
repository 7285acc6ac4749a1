// Computes discs around the discs of each node's children. One group does all levels that it has invocations for.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/surface_tree.glsl"
#include "vulkan/stages/surface_shapes.glsl"

layout(constant_id = 1) const uint kNodes = 1;  // Invocations of a group.

shared vec4 discsBelow[kNodes * kDiscVectors];
uint firstShared = 0xffffffffu;  // First node of the level below, if that lies in shared memory.

Disc readBelow(uint node) {
  if (node < firstShared) return readDisc(push.discs, node);
  const uint at = (node - firstShared) * kDiscVectors;
  return Disc(discsBelow[at].xyz, discsBelow[at + 1].xyz, discsBelow[at].w, discsBelow[at + 1].w);
}

Disc boundDiscs(uint first, uint count) {
  vec3 low = vec3(kLargestFloat), high = -low, normal = vec3(0);
  for (uint child = first; child < first + count; ++child) {
    const Disc disc = readBelow(child);
    low = min(low, disc.centre);
    high = max(high, disc.centre);
    normal += disc.normal * (disc.radius * disc.radius);
  }
  normal = unitVector(normal);
  const vec3 middle = 0.5 * (low + high);
  // Extents of the discs along and across the common normal.
  float front = -kLargestFloat, back = -front, radius = 0, reach = 0;
  for (uint child = first; child < first + count; ++child) {
    const Disc disc = readBelow(child);
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
  uint start = push.levelStart, count = push.levelCount, below = push.levelBelowCount;
  const uint node = invocationIndex();
  while (true) {
    Disc disc = discOutOfReach();
    if (node < count) disc = boundDiscs((start + node) * kTreeArity + 1, min(kTreeArity, below - node * kTreeArity));
    if (node < placesOf(start, count)) writeDisc(push.discs, start + node, disc);
    if (start == 0 || count > kNodes) return;
    barrier();
    discsBelow[gl_LocalInvocationID.x * kDiscVectors] = vec4(disc.centre, disc.radius);
    discsBelow[gl_LocalInvocationID.x * kDiscVectors + 1] = vec4(disc.normal, disc.halfThickness);
    barrier();
    firstShared = start;
    start = (start - 1) / kTreeArity;
    below = count;
    count = ceilDiv(count, kTreeArity);
  }
}
