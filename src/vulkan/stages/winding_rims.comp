// Computes winding numbers of samples from a ray and the rims. GPU twin of cpu/sign/winding_rims_samples.cpp (Martens,
// Trettner & Bessmeltsev 2026, "The Antipodal Method").
#include "vulkan/device/kernel.glsl"
#include "method/winding_doubts_shared.h"
#include "method/winding_rims_shared.h"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/arc_tangent.glsl"
#include "vulkan/stages/ray_map.glsl"
#include "vulkan/stages/winding_rims_push.h"

// Whether the samples to compute are listed; else they are those that may lie on the wrong side of the threshold, or
// those at the threshold itself, which dipoles leave.
layout(constant_id = 1) const uint kIsListed = 1;
layout(push_constant, scalar) uniform Push { WindingRimsPush push; };

vec3 unit(vec3 v) {
  return v * inversesqrt(max(dot(v, v), 1e-30));
}

// Returns what the rims add to the crossings of the ray along `direction`, the same to all lanes of a subgroup. Half of each
// solid angle is the argument of a complex number. `clearance` is how far the ray passes the rims by, as an angle, about.
float shareOfRims(vec3 p, vec3 direction, out float clearance) {
  vec2 product = vec2(1, 0);
  float turns = 0;
  clearance = 4;
  for (uint i = gl_SubgroupInvocationID; i < push.rimCount; i += gl_SubgroupSize) {
    const vec3 a = unit(vectorAt(push.rims, 2 * i) - p), b = unit(vectorAt(push.rims, 2 * i + 1) - p);
    const vec2 factor = vec2(1 + dot(a, b) - dot(a, direction) - dot(b, direction), -dot(cross(a, b), direction));
    clearance = min(clearance, max(factor.x, abs(factor.y)));
    if (max(abs(factor.x), abs(factor.y)) < 1e-6) continue;
    const vec2 next = vec2(product.x * factor.x - product.y * factor.y, product.x * factor.y + product.y * factor.x);
    // Two arguments of the same sign pass the negative axis if the sum's sign differs.
    if (product.y >= 0 && factor.y > 0 && next.y < 0) turns += 1;
    if (product.y < 0 && factor.y < 0 && next.y >= 0) turns -= 1;
    product = next / (abs(next.x) + abs(next.y));
  }
  clearance = subgroupMin(clearance);
  return subgroupAdd(turns + arcTangent(product.y, product.x) / (2 * kPi));
}

// Returns the crossings of the ray from a sample, which may lie outside of the grid.
int crossingsAlong(Ints rays, uint axis, ivec3 s, bool isForward) {
  const ivec3 dims = ivec3(push.dims);
  ivec3 across = s;
  across[axis] = 0;
  if (any(lessThan(across, ivec3(0))) || any(greaterThanEqual(across, dims))) return 0;
  ivec3 before = s;
  before[axis] = -1;
  const int after = rayFrom(rays, axis, dims, s);
  return isForward ? after : after - rayFrom(rays, axis, dims, before);
}

float crossingsOf(ivec3 s, uint ray) {
  const bool isForward = ray < 3;
  if (ray % 3 == 0) return crossingsAlong(push.rays[0], 0, s, isForward);
  if (ray % 3 == 1) return crossingsAlong(push.rays[1], 1, s, isForward);
  return crossingsAlong(push.rays[2], 2, s, isForward);
}

float rounded(float winding) {
  return floor(winding * kRimUnits + 0.5) / kRimUnits;
}

float windingNumber(ivec3 s) {
  const vec3 p = vec3(s), fromCentre = p - push.centre;
  float best = 0, most = 0, clearance;
  for (uint i = 0; i < 6 && most < kClearOfRims; ++i) {
    const uint ray = rayToTry(i, fromCentre);
    vec3 direction = vec3(0);
    direction[ray % 3] = ray < 3 ? 1 : -1;
    const float share = shareOfRims(p, direction, clearance);
    if (clearance > most) best = crossingsOf(s, ray) + share;
    most = max(most, clearance);
  }
  if (most >= kLeastClearance) return rounded(best);
  const vec3 displacement = vec3(kDisplacement[0], kDisplacement[1], kDisplacement[2]);
  return rounded(crossingsOf(s, 0) + shareOfRims(p + displacement, vec3(1, 0, 0), clearance));
}

// All lanes of a subgroup compute the number; one writes it.
void compute(uint place, bool writes) {
  const uvec3 dims = uvec3(rimDims(ivec3(push.dims), push.level));
  const float w = windingNumber(ivec3(placeOf(place, dims)) << int(push.level));
  if (writes) push.values.at[place] = w;
}

bool isDoubtful(uint place) {
  const float w = push.values.at[place];
  return uint64_t(push.change) == 0
      ? abs(w) == push.threshold
      : isDoubtful(w, push.threshold, push.source, push.distance.at[place], push.change.at[0]);
}

void main() {
  if (kIsListed != 0) {
    const uint i = groupIndex() * gl_NumSubgroups + gl_SubgroupID;
    if (i < push.count) compute(push.computed.at[i], subgroupElect());
    return;
  }
  const uint place = groupIndex() * gl_WorkGroupSize.x + laneIndex();
  uvec4 doubtful = subgroupBallot(place < push.count && isDoubtful(place));
  while (subgroupBallotBitCount(doubtful) > 0) {
    const uint lane = subgroupBallotFindLSB(doubtful);
    doubtful[lane / 32] &= ~(1u << lane % 32);
    compute(subgroupBroadcast(place, lane), gl_SubgroupInvocationID == lane);  // It has read what it overwrites.
  }
}
