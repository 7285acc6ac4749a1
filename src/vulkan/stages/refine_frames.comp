// Gives each triangle a frame of its own, in which its distance to a point needs no division. Floats suffice here:
// surface_frames.glsl takes twenty times as many operations, for errors a few times smaller.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/refine.glsl"
#include "vulkan/stages/mesh.glsl"

// Returns a unit vector perpendicular to the unit vector `x`, closest to the direction of `e` if that is possible.
vec3 directionAcross(vec3 x, vec3 e) {
  vec3 y = e - dot(e, x) * x;
  if (!(dot(y, y) > 1e-12 * dot(e, e))) y = abs(x.x) < 0.6 ? vec3(1, 0, 0) : vec3(0, 1, 0);
  // The second round takes what rounding has left along x.
  [[unroll]] for (uint round = 0; round < 2; ++round) y = normalize(y - dot(y, x) * x);
  return y;
}

float inverseOf(float square) {
  return square > 0 ? 1 / square : 0;
}

// The longest edge becomes ab, so that c lies over it and slivers keep a sound frame.
Triangle frameOf(vec3 p, vec3 q, vec3 r) {
  const float pq2 = dot(q - p, q - p), qr2 = dot(r - q, r - q), rp2 = dot(p - r, p - r);
  const bool fromQ = qr2 >= pq2 && qr2 >= rp2, fromR = !fromQ && rp2 > pq2;
  const vec3 a = fromQ ? q : fromR ? r : p, b = fromQ ? r : fromR ? p : q, c = fromQ ? p : fromR ? q : r;
  const float bx = length(b - a);
  const vec3 x = bx > 0 ? (b - a) / bx : vec3(1, 0, 0), y = directionAcross(x, c - a);
  const float cx = clamp(dot(c - a, x), 0, bx), cy = max(dot(c - a, y), 0);
  return Triangle(a, x, y, cross(x, y), bx, cx, cy, inverseOf((cx - bx) * (cx - bx) + cy * cy), inverseOf(cx * cx + cy * cy));
}

void main() {
  const uint triangle = invocationIndex();
  if (triangle >= push.triangleCount) return;
  const mat3 corners = cornersOf(push.vertices, push.triangles, triangle);
  writeTriangle(push.frames, triangle, frameOf(corners[0], corners[1], corners[2]), triangle);
}
