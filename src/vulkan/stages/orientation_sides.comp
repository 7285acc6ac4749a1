// Measures the field in front of each face and behind it, in the mean over places on the face
// (cpu/sign/orientation.cpp).
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/mesh.glsl"
#include "vulkan/stages/orientation.glsl"

vec3 inGrid(vec3 p) {
  return clamp(p, vec3(0), vec3(gridDims() - 1));
}

float alongX(uint at, uint x, float t) {
  return push.field.at[at] + t * (push.field.at[at + x] - push.field.at[at]);
}

float alongY(uint at, uint x, uint y, vec3 t) {
  const float first = alongX(at, x, t.x);
  return first + t.y * (alongX(at + y, x, t.x) - first);
}

float fieldAt(vec3 p) {
  const ivec3 dims = gridDims();
  const ivec3 low = min(ivec3(p), max(dims - 2, ivec3(0)));
  const vec3 t = p - vec3(low);
  const uint x = dims.x > 1 ? 1 : 0, y = dims.y > 1 ? push.dims.x : 0, z = dims.z > 1 ? push.dims.x * push.dims.y : 0;
  const uint at = indexOf(uvec3(low), push.dims);
  const float first = alongY(at, x, y, t);
  return first + t.z * (alongY(at + z, x, y, t) - first);
}

float sidesAt(vec3 p, vec3 along) {
  const float before = fieldAt(inGrid(p + along)), behind = fieldAt(inGrid(p - along));
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
  push.sides.at[t] = sidesOf(readCorner(push.vertices, push.triangles, t, 0), readCorner(push.vertices, push.triangles, t, 1),
                            readCorner(push.vertices, push.triangles, t, 2));
}
