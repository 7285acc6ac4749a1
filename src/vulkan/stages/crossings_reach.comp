// Finds the largest distance of triangle corners from sample (0, 0, 0) along an axis. Vertices without
// triangles are ignored.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/crossings.glsl"

shared uint reachOfGroup;

void main() {
  if (gl_LocalInvocationIndex == 0) reachOfGroup = 0;
  barrier();
  const uint triangle = invocationIndex();
  uint reach = 0;
  if (triangle < push.triangleCount) {
    for (uint corner = 0; corner < 3; ++corner) {
      const uvec3 bits = floatBitsToUint(abs(cornerOf(triangle, corner)));
      const uint furthest = max(max(bits.x, bits.y), bits.z);
      if (exponentOf(furthest) >= kCoordinateBits)
        atomicMax(push.status.now.tooFarCorner, ~(3 * triangle + corner));
      reach = max(reach, furthest);
    }
  }
  reach = subgroupMax(reach);
  if (subgroupElect()) atomicMax(reachOfGroup, reach);
  barrier();
  if (gl_LocalInvocationIndex == 0) atomicMax(push.status.now.reach, reachOfGroup);
}
