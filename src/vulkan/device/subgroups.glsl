// For kernels whose groups are made of full subgroups, of whatever size (see ComputePipeline).

#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require

// The order in which subgroups hold a group's invocations; gl_LocalInvocationIndex may have another.
uint laneIndex() {
  return gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID;
}
