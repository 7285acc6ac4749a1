// Measures the field in front of each face and behind it, in the mean over places on the face
// (cpu/sign/orientation.cpp).
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/mesh.glsl"
#include "vulkan/stages/orientation.glsl"
#include "vulkan/stages/trilinear.glsl"

vec3 inGrid(vec3 p) {
  return clamp(p, vec3(0), vec3(gridDims() - 1));
}

float sidesAt(vec3 p, vec3 along) {
  const float before = between(push.field, gridDims(), inGrid(p + along));
  const float behind = between(push.field, gridDims(), inGrid(p - along));
  if (push.isWholeness == 0) return before - behind;
  const float halved = 0.5 * (before + behind - 1.0);  // Whole where the sum is odd.
  return 1.0 - 2.0 * abs(halved - round(halved));
}

float sidesOf(vec3 a, vec3 b, vec3 c) {
  const vec3 ab = b - a, ac = c - a, across = cross(ab, ac);
  const float doubleArea = length(across);
  if (!(doubleArea > 0)) return 0;
  const vec3 along = across / doubleArea * max(1.0, push.farSides * sqrt(doubleArea));
  const float longest = max(max(length(ab), length(ac)), length(c - b));
  const int parts = int(clamp(ceil(longest / kPartLength), 1.0, kMostParts));
  const vec3 u = ab / float(parts), v = ac / float(parts);
  float sum = 0;
  for (int i = 0; i < parts; ++i)
    for (int j = 0; i + j < parts; ++j) {
      const vec3 corner = a + float(i) * u + float(j) * v;
      sum += sidesAt(corner + (u + v) / 3.0, along);
      if (i + j + 1 < parts) sum += sidesAt(corner + (u + v) * (2.0 / 3.0), along);
    }
  return sum / float(parts * parts);
}

void main() {
  const uint t = invocationIndex();
  if (t >= push.triangleCount) return;
  const mat3 corners = cornersOf(push.vertices, push.triangles, t);
  push.sides.at[t] = sidesOf(corners[0], corners[1], corners[2]);
}
