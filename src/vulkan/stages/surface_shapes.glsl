// Triangles and discs of the surface tree. GPU twin of cpu/distance/surface_shapes-inl.h. Nodes are numbered
// from the root on, level by level. Node n has the children 8 n + 1 to 8 n + 8. Leaf n has the triangles 8 n
// to 8 n + 7. Include after surface_tree_push.h.

#include "vulkan/stages/roots.glsl"

// Triangle in a frame of its own: corner a is the origin, b = (bx, 0), c = (cx, cy) with 0 <= cx <= bx and
// cy >= 0, rounding included. In this form the distance to a point needs no division.
struct Triangle {
  vec3 a, x, y, z;
  float bx, cx, cy;
  float inverseBc2, inverseCa2;  // 1 / |c - b|^2 and 1 / |a - c|^2; 0 for an edge without length.
};

// Discs are larger than what they bound by `kOutwards`, which makes up for the rounding of distances to them.
struct Disc {
  vec3 centre, normal;  // The normal has length 1.
  float radius, halfThickness;
};

// Returns the disc for nodes without triangles, out of reach of every point: its radius is negative.
Disc discOutOfReach() {
  return Disc(vec3(0), vec3(0, 0, 1), -1, 0);
}

Triangle readTriangle(Vec4s frames, uint index) {
  const uint at = index * kFrameVectors;
  const vec4 a = frames.at[at], x = frames.at[at + 1], y = frames.at[at + 2], rest = frames.at[at + 3];
  return Triangle(a.xyz, x.xyz, y.xyz, cross(x.xyz, y.xyz), a.w, x.w, y.w, rest.x, rest.y);
}

void writeTriangle(Vec4s frames, uint index, Triangle t, uint id) {
  frames.at[index * kFrameVectors] = vec4(t.a, t.bx);
  frames.at[index * kFrameVectors + 1] = vec4(t.x, t.cx);
  frames.at[index * kFrameVectors + 2] = vec4(t.y, t.cy);
  frames.at[index * kFrameVectors + 3] = vec4(t.inverseBc2, t.inverseCa2, uintBitsToFloat(id), 0);
}

// Returns a disc that surely bounds what fits into this one but for rounding. Its parts lie up to `reach` from the
// place where its centre was computed.
Disc outwards(Disc disc, float reach) {
  const vec3 c = abs(disc.centre);
  const float slack = kOutwards * reach + 2.5e-7 * max(max(c.x, c.y), c.z);  // The centre was rounded.
  return Disc(disc.centre, disc.normal, disc.radius + slack, disc.halfThickness + slack);
}

// Returns the triangle's number in the mesh.
uint readTriangleId(Vec4s frames, uint index) {
  return floatBitsToUint(frames.at[index * kFrameVectors + 3].z);
}

Disc readDisc(Vec4s discs, uint node) {
  const vec4 first = discs.at[node * kDiscVectors], second = discs.at[node * kDiscVectors + 1];
  return Disc(first.xyz, second.xyz, first.w, second.w);
}

void writeDisc(Vec4s discs, uint node, Disc disc) {
  discs.at[node * kDiscVectors] = vec4(disc.centre, disc.radius);
  discs.at[node * kDiscVectors + 1] = vec4(disc.normal, disc.halfThickness);
}

// Returns the offset, in a triangle's frame, from the closest point of the triangle to a point. As ab is the longest
// edge, that point lies on ab below it. Elsewhere it lies on the edge that meets ab on the point's side of c, or inside.
vec3 offsetFrom(Triangle t, vec3 point) {
  const vec3 q = point - t.a, p = vec3(dot(q, t.x), dot(q, t.y), dot(q, t.z));
  const bvec2 isBeyondC = bvec2(p.x > t.cx), isBelow = bvec2(p.y <= 0);
  const vec2 c = vec2(t.cx, t.cy), e = mix(c, vec2(t.bx - t.cx, -t.cy), isBeyondC);
  const vec2 u = mix(p.xy, p.xy - c, isBeyondC), below = vec2(p.x - clamp(p.x, 0, t.bx), p.y);
  const float share = clamp(dot(u, e) * mix(t.inverseCa2, t.inverseBc2, isBeyondC.x), 0, 1);
  // Never inside a triangle without area.
  const bool isInside = min(p.y, e.y * u.x - e.x * u.y) > 0;
  return vec3(mix(mix(u - share * e, below, isBelow), vec2(0), bvec2(isInside)), p.z);
}

float squaredDistance(Triangle t, vec3 point) {
  const vec3 o = offsetFrom(t, point);
  return o.z * o.z + (o.x * o.x + o.y * o.y);
}

// Distance to a convex shape and its gradient at a point: the tangent plane.
struct Tangent {
  float d;
  vec3 g;
};

Tangent tangentOf(Triangle t, vec3 point) {
  const vec3 o = offsetFrom(t, point);
  const float squared = max(dot(o, o), 1e-30), inverse = inverseRoot(squared);
  return Tangent(squared * inverse, mat3(t.x, t.y, t.z) * (inverse * o));
}

// Distances of a point from a disc, beside it and above or below it.
struct DiscOffset {
  vec3 q;
  float height, inverseRho, beside, above;
};

DiscOffset discOffset(Disc disc, vec3 point) {
  DiscOffset o;
  o.q = point - disc.centre;
  o.height = dot(o.q, disc.normal);
  const float rho2 = max(dot(o.q, o.q) - o.height * o.height, 1e-30);
  o.inverseRho = inverseRoot(rho2);
  o.beside = max(rho2 * o.inverseRho - disc.radius, 0);
  o.above = max(abs(o.height) - disc.halfThickness, 0);
  return o;
}

// Returns at most the squared distance to what the disc bounds.
float squaredDistance(Disc disc, vec3 point) {
  if (disc.radius < 0) return kLargestFloat;
  const DiscOffset o = discOffset(disc, point);
  return (1 - 2 * kOutwards) * (o.beside * o.beside + o.above * o.above);
}

// Returns a plane below the distance to what the disc bounds.
Tangent tangentOf(Disc disc, vec3 point) {
  const DiscOffset o = discOffset(disc, point);
  const float squared = max(o.beside * o.beside + o.above * o.above, 1e-30);
  const float inverse = inverseRoot(squared);
  const float radial = o.beside * inverse * o.inverseRho;
  const float axial = (o.height < 0 ? -o.above : o.above) * inverse - radial * o.height;
  return Tangent((1 - kOutwards) * squared * inverse, axial * disc.normal + radial * o.q);
}
