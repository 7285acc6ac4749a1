// Computes the winding numbers of the triangles themselves at given points, one in each work group.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/winding_dipoles.glsl"
#include "vulkan/stages/arc_tangent.glsl"
#include "vulkan/stages/winding_number.glsl"

void main() {
  const uint i = groupIndex();
  if (i >= push.pointCount) return;
  const vec3 p = vectorAt(push.points, i);
  const Winding found = windingNumber(p, kDistant[2], push.mostTurns);
  if (gl_LocalInvocationIndex == 0) push.winding.at[i] = found.isWhole ? found.number : push.threshold;
}
