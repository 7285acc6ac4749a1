// Barill et al. 2018, "Fast winding numbers for soups and clouds": declarations shared by the kernels. GPU
// twin of cpu/sign/winding_dipoles.cpp.

#include "vulkan/stages/surface_tree_push.h"
#include "vulkan/stages/winding_dipoles_push.h"
#include "vulkan/stages/surface_shapes.glsl"

layout(push_constant, scalar) uniform Push { WindingDipolesPush push; };

// Moments of a node about its disc's centre: the area vector, and the symmetric part of area vector times
// offset.
struct Moments {
  vec3 area;
  vec3 squares;   // xx, yy, zz.
  vec3 products;  // xy, yz, zx.
};

Moments readMoments(uint node) {
  const vec4 a = push.moments.at[node * kMomentVectors], b = push.moments.at[node * kMomentVectors + 1],
             c = push.moments.at[node * kMomentVectors + 2];
  return Moments(a.xyz, b.xyz, c.xyz);
}

void writeMoments(uint node, Moments m) {
  push.moments.at[node * kMomentVectors] = vec4(m.area, 0);
  push.moments.at[node * kMomentVectors + 1] = vec4(m.squares, 0);
  push.moments.at[node * kMomentVectors + 2] = vec4(m.products, 0);
}

// Dipoles are asked only for fields that fit all crossings.
bool isDoubtful(uint index) {
  return isDoubtful(push.winding.at[index], push.threshold, kFromFit, push.distance.at[index], push.change.at[0]);
}
