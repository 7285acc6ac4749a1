// Krayer & Müller 2019, §3.5, end: the winding number's threshold, and the confidence. GPU twin of cpu/sign/sign.h.

#include "vulkan/stages/ray_map.glsl"
#include "vulkan/stages/finish_push.h"

layout(push_constant, scalar) uniform Push { FinishPush push; };

// Returns how many of the two rays along an axis give the same sign, each on its own.
uint votes(Ints rays, uint axis, ivec3 s, ivec3 dims, bool inside) {
  ivec3 beforeAll = s;
  beforeAll[axis] = -1;
  const int ray = rayFrom(rays, axis, dims, s);
  const int back = ray - rayFrom(rays, axis, dims, beforeAll);
  return uint((abs(float(ray)) > push.threshold) == inside) + uint((abs(float(back)) > push.threshold) == inside);
}

float rate(float w, bool inside, ivec3 s, ivec3 dims) {
  const float below = 1.0 / push.threshold;
  const float above = push.threshold < 1.0 ? 1.0 / (1.0 - push.threshold) : below;
  const float margin = inside ? (w - push.threshold) * above : (push.threshold - w) * below;
  const uint agreeing = votes(push.rays[0], 0, s, dims, inside) + votes(push.rays[1], 1, s, dims, inside) +
                        votes(push.rays[2], 2, s, dims, inside);
  return min(margin, 1.0) * (6.0 + float(agreeing)) / 12.0;
}

void writeConfidence(uint i, float w, bool inside) {
  const ivec3 dims = ivec3(push.dims);
  push.confidence.at[i] = rate(w, inside, ivec3(placeOf(i, push.dims)), dims);
}

// Returns the distance with the sign that the size of the winding number gives.
float signedBy(float w, float distance, uint i) {
  const bool inside = w > push.threshold;
  if (uint64_t(push.confidence) != 0) writeConfidence(i, w, inside);
  return inside != (push.isInverted != 0) ? -distance : distance;
}
