// Replaces the winding numbers of doubtful samples by those of the triangles themselves. A work group computes one
// sample of the list. If the list could not hold all, it goes through some samples of the grid instead.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_dipoles.glsl"
#include "vulkan/stages/arc_tangent.glsl"
#include "vulkan/stages/winding_number.glsl"

// Doubts of the group's samples, read by one invocation each. `settle` writes the numbers that they depend on, and all
// invocations of a group must reach its barriers. These order shared memory alone, so the same invocation writes.
shared bool areDoubtful[kSamplesPerListed];

void settle(uint index, uint mostTurns, bool isOwn) {
  const vec3 p = vec3(placeOf(index, push.dims));
  bool isSure = false;
  float w = 0;
  if (isOwn) w = push.winding.at[index];
  for (uint look = 0; look < push.looks && !isSure; ++look) {
    const Winding found = windingNumber(p, kDistant[look], mostTurns);
    if (!found.isWhole) break;  // Keeps the last value.
    w = found.number;
    isSure = abs(abs(w) - push.threshold) >= max(kClose[look], found.error);
  }
  // At the threshold itself, winding_rims.comp replaces it.
  if (push.rimsDecide != 0 && (!isSure || push.distance.at[index] <= kOnSurface)) w = push.threshold;
  if (isOwn) push.winding.at[index] = w;
}

void main() {
  const uint count = push.doubts.at[0];
  const bool isListed = count <= push.mostListed;
  const uint group = push.firstGroup + groupIndex();
  if (group >= (isListed ? count : ceilDiv(countOf(push.dims), kSamplesPerListed))) return;
  const uint first = isListed ? push.doubts.at[1 + group] : group * kSamplesPerListed;
  const uint samples = isListed ? 1 : min(kSamplesPerListed, countOf(push.dims) - first);
  if (gl_LocalInvocationIndex < samples)
    areDoubtful[gl_LocalInvocationIndex] = isDoubtful(first + gl_LocalInvocationIndex);
  barrier();
  const uint turnsOfEach = push.mostTurns / (isListed ? 1 : kSamplesPerListed);
  for (uint i = 0; i < samples; ++i)
    if (areDoubtful[i]) settle(first + i, turnsOfEach * (i + 1), gl_LocalInvocationIndex == i);
}
