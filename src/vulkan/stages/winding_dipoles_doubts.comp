// Finds whether some sample is so close to the threshold that the lattice may have put it on the wrong side.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/winding_dipoles.glsl"

#extension GL_KHR_shader_subgroup_vote : require

void main() {
  const uint i = invocationIndex();
  const bool found = push.disagreeing.at[0] != 0 && i < sampleCount() && isDoubtful(i);
  if (subgroupAny(found) && subgroupElect()) push.doubts.at[0] = 1;
}
