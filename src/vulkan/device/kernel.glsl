// What every kernel includes first.

#extension GL_EXT_buffer_reference : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

layout(local_size_x_id = 0) in;

// One type for each kind of element. Indices are taken as signed: below 2^31.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Uints { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Ints { int at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Floats { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Uvec4s { uvec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Vec4s { vec4 at[]; };

// Of work groups in one dispatch, which may spread over y; some at the end may be too many: check bounds.
uint groupIndex() {
  return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

uint invocationIndex() {
  return groupIndex() * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

uint ceilDiv(uint a, uint b) {
  return a / b + uint(a % b != 0);
}

// A number that the host knows, or that the device alone does, at an address; never more than `most`.
uint readCount(Uints address, uint most) {
  return uint64_t(address) == 0 ? most : min(address.at[0], most);
}
