// Declarations shared by the kernels of the surface tree.

#include "vulkan/stages/surface_tree_push.h"

layout(push_constant, scalar) uniform Push { SurfaceTreePush push; };

vec3 readCorner(uint triangle, uint corner) {
  return vectorAt(push.vertices, push.triangles.at[3 * triangle + corner]);
}

// Returns the number of a level's nodes, including those that fill up its last eight; the root has no
// siblings.
uint placesOf(uint start, uint count) {
  return start == 0 ? 1 : ceilDiv(count, kTreeArity) * kTreeArity;
}

// Returns an arbitrary direction for a zero vector.
vec3 unitVector(vec3 v) {
  const float length2 = dot(v, v);
  if (!(length2 > 1e-24)) return vec3(0, 0, 1);
  v *= inversesqrt(length2);
  return v * (1.5 - 0.5 * dot(v, v));  // Devices may be a few units in the last place off.
}
