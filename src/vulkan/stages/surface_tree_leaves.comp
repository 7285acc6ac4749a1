// Gives each triangle a frame of its own, and each leaf a disc around its eight triangles.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/surface_tree.glsl"
#include "vulkan/stages/surface_shapes.glsl"

layout(constant_id = 1) const uint kLeaves = 1;  // Leaves per group.

shared vec3 corners[kLeaves * kArity * 3];

// Returns a unit vector perpendicular to the unit vector `x` and to `e`. If the cross product is mostly
// rounding error, it may point along `x`. Then `e` lies along `x`, and any direction perpendicular to `x`
// will do.
dvec3 directionAcross(dvec3 x, dvec3 e) {
  dvec3 v = cross(x, e);
  if (!(dot(v, v) > 1e-18lf * dot(e, e))) v = cross(x, abs(x.x) < 0.6lf ? dvec3(1, 0, 0) : dvec3(0, 1, 0));
  return v / sqrt(dot(v, v));
}

float inverseOf(double square) {
  return square > 1e-30lf ? float(1 / square) : 0;
}

// The longest edge becomes ab, so that c lies over it and slivers keep a sound frame.
Triangle makeFrame(dvec3 p, dvec3 q, dvec3 r) {
  const double pq2 = dot(q - p, q - p), qr2 = dot(r - q, r - q), rp2 = dot(p - r, p - r);
  const bool fromQ = qr2 >= pq2 && qr2 >= rp2, fromR = !fromQ && rp2 > pq2;
  const dvec3 a = fromQ ? q : fromR ? r : p, b = fromQ ? r : fromR ? p : q, c = fromQ ? p : fromR ? q : r;
  const dvec3 ab = b - a, e = c - a;
  const double bx = sqrt(dot(ab, ab));
  const dvec3 x = bx > 0 ? ab / bx : dvec3(1, 0, 0), z = directionAcross(x, e), y = cross(z, x);
  const double cx = dot(e, x), cy = dot(e, y);
  return Triangle(vec3(a), vec3(x), vec3(y), vec3(z), float(bx), float(cx), float(cy),
                  inverseOf((cx - bx) * (cx - bx) + cy * cy), inverseOf(cx * cx + cy * cy));
}

Disc boundCorners(uint first) {
  vec3 low = vec3(kFarthest), high = -low, normal = vec3(0);
  for (uint i = first; i < first + 3 * kArity; i += 3) {
    const vec3 a = corners[i], b = corners[i + 1], c = corners[i + 2];
    low = min(min(low, a), min(b, c));
    high = max(max(high, a), max(b, c));
    normal += cross(b - a, c - a);
  }
  normal = unitVector(normal);
  const vec3 middle = 0.5 * (low + high);
  float front = -kFarthest, back = -front, radius2 = 0;
  for (uint i = first; i < first + 3 * kArity; ++i) {
    const vec3 q = corners[i] - middle;
    const float height = dot(q, normal);
    front = max(front, height);
    back = min(back, height);
    radius2 = max(radius2, dot(q, q) - height * height);
  }
  return Disc(middle + 0.5 * (front + back) * normal, normal, sqrt(radius2), 0.5 * (front - back));
}

void main() {
  const uint place = invocationIndex(), leaf = groupIndex() * kLeaves + gl_LocalInvocationID.x;
  if (place / kArity < push.levelCount) {
    // The last triangle fills up the last leaf.
    const uint triangle = push.order.at[min(place, push.triangleCount - 1)];
    const vec3 p = readCorner(triangle, 0), q = readCorner(triangle, 1), r = readCorner(triangle, 2);
    writeTriangle(push.frames, place, makeFrame(p, q, r), triangle);
    corners[3 * gl_LocalInvocationID.x] = p;
    corners[3 * gl_LocalInvocationID.x + 1] = q;
    corners[3 * gl_LocalInvocationID.x + 2] = r;
  }
  barrier();
  if (gl_LocalInvocationID.x >= kLeaves || leaf >= levelPlaces()) return;
  writeDisc(push.discs, push.levelStart + leaf,
            leaf < push.levelCount ? boundCorners(3 * kArity * gl_LocalInvocationID.x) : discOutOfReach());
}
