// For kernels whose groups consist of full subgroups, of any size (see ComputePipeline).

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require

// Returns the invocation's index in the order of subgroups; gl_LocalInvocationIndex may have another order.
uint laneIndex() {
  return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID;
}

// Returns the least of values that are 0 or more. Their bits have the same order, and cards reduce integers in one
// instruction.
float subgroupMinSquare(float value) {
  return uintBitsToFloat(subgroupMin(floatBitsToUint(value)));
}
