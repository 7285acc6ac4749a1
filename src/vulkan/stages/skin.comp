// Linear-blend skinning: moves each vertex to the weighted mean of the places to which its joints move it.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/skin_push.h"

layout(push_constant, scalar) uniform Push { SkinPush push; };

// Returns not-a-number for a nonexistent joint, which the stages that read the vertex detect.
vec3 movedBy(uint joint, vec4 rest) {
  if (joint >= push.jointCount) return vec3(uintBitsToFloat(0x7fc00000u));
  const uint row = 3 * joint;
  return vec3(dot(push.matrices.at[row], rest), dot(push.matrices.at[row + 1], rest),
              dot(push.matrices.at[row + 2], rest));
}

vec3 blended(uint vertex, vec4 rest) {
  const uvec2 pairs = uvec2(push.joints.at[2 * vertex], push.joints.at[2 * vertex + 1]);
  const uvec4 joints = uvec4(pairs.x & 0xffffu, pairs.x >> 16, pairs.y & 0xffffu, pairs.y >> 16);
  const vec4 weights = push.weights.at[vertex];
  vec3 sum = vec3(0);
  for (int k = 0; k < 4; ++k)
    if (weights[k] != 0) sum += weights[k] * movedBy(joints[k], rest);
  return sum;
}

void main() {
  const uint v = invocationIndex();
  if (v >= push.vertexCount) return;
  const vec4 rest = vec4(vectorAt(push.rest, v), 1);
  const vec3 p = uint64_t(push.joints) == 0 ? movedBy(0, rest) : blended(v, rest);
  for (uint axis = 0; axis < 3; ++axis) push.vertices.at[3 * v + axis] = p[axis];
}
