// Computes lower bounds on the distance from a point to a disc.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/surface_tree_push.h"
#include "vulkan/stages/surface_shapes.glsl"
#include "disc_bounds.h"

layout(push_constant, scalar) uniform Push { DiscBoundsPush push; };

void main() {
  const uint i = invocationIndex();
  if (i >= push.count) return;
  const Disc disc = readDisc(push.discs, i);
  const Tangent tangent = tangentOf(disc, push.points.at[i].xyz);
  push.planes.at[i] = vec4(tangent.g, tangent.d);
  push.squared.at[i] = squaredDistance(disc, push.points.at[i].xyz);
}
