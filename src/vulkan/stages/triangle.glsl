// Basic geometric functions. GPU twins of cpu/cells/triangle.h, with the same rounding.

#include "vulkan/primitives/rounded_division.glsl"

float dotExactly(vec3 a, vec3 b) {
  precise const float sum = a.x * b.x + a.y * b.y + a.z * b.z;
  return sum;
}

vec3 crossExactly(vec3 a, vec3 b) {
  precise const vec3 product = vec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
  return product;
}

float squaredLength(vec3 v) {
  return dotExactly(v, v);
}

// Returns the squared distance from the origin to the segment from a to a + e, which may be a point.
float segmentSquaredDistance(vec3 a, vec3 e) {
  const float length2 = squaredLength(e);
  const float t = length2 > 0.0 ? clamp(divideRounded(-dotExactly(a, e), length2), 0.0, 1.0) : 0.0;
  precise const vec3 closest = a + t * e;
  return squaredLength(closest);
}

// Returns the squared distance from p to the triangle abc, which may be a segment or a point.
float triangleSquaredDistance(vec3 p, vec3 a, vec3 b, vec3 c) {
  const vec3 pa = a - p, ab = b - a, ac = c - a;
  const vec3 n = crossExactly(ab, ac);
  const float area2 = squaredLength(n);
  // Barycentric coordinates of the projection of p, times area2.
  const float v = dotExactly(crossExactly(ac, pa), n);
  const float w = dotExactly(crossExactly(pa, ab), n);
  float inside = kLargestFloat;
  if (v >= 0.0 && w >= 0.0 && v + w <= area2 && area2 > 0.0) {
    precise const vec3 closest = pa + divideRounded(v, area2) * ab + divideRounded(w, area2) * ac;
    inside = squaredLength(closest);
    // Except for slivers the projection is the closest point: the edges lie farther away.
    precise const float square = 1e-6 * squaredLength(ab) * squaredLength(ac);
    if (area2 > square) return inside;
  }
  const float edges = min(segmentSquaredDistance(pa, ab), segmentSquaredDistance(pa, ac));
  return min(min(inside, edges), segmentSquaredDistance(b - p, c - b));
}
