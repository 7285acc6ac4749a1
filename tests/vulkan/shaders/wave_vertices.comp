// An animation: vertices move along x with a wave that runs along z.
#include "vulkan/device/kernel.glsl"
#include "wave_vertices.h"

layout(push_constant, scalar) uniform Push { WaveVerticesPush push; };

void main() {
  const uint v = invocationIndex();
  if (v >= push.count) return;
  vec3 p = vec3(push.rest.at[3 * v], push.rest.at[3 * v + 1], push.rest.at[3 * v + 2]);
  p.x += 0.2 * sin(push.time + 3.0 * p.z);
  for (uint axis = 0; axis < 3; ++axis) push.moved.at[3 * v + axis] = p[axis];
}
