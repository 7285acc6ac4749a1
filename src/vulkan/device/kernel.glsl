// Included first by every kernel. The build sets the version of GLSL.

#extension GL_EXT_buffer_reference : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

layout(local_size_x_id = 0) in;

// One type for each kind of element. Indices are read as signed: below 2^31.
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Uints { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Ints { int at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Floats { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Uint64s { uint64_t at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Uvec4s { uvec4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) buffer Vec4s { vec4 at[]; };

// Returns the index of this work group among those of the whole work, which may extend over y and over several
// dispatches. The last groups may be surplus: check bounds.
uint groupIndex() {
  return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

uint invocationIndex() {
  return groupIndex() * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

uint ceilDiv(uint a, uint b) {
  return a / b + uint(a % b != 0);
}

// Number, places and indices of the samples or cells of a lattice, x fastest.
uint countOf(uvec3 dims) {
  return dims.x * dims.y * dims.z;
}
uvec3 placeOf(uint index, uvec3 dims) {
  const uint row = index / dims.x;
  return uvec3(index % dims.x, row % dims.y, row / dims.y);
}
uint indexOf(uvec3 place, uvec3 dims) {
  return (place.z * dims.y + place.y) * dims.x + place.x;
}

// Returns a vector of three packed floats.
vec3 vectorAt(Floats from, uint index) {
  return vec3(from.at[3 * index], from.at[3 * index + 1], from.at[3 * index + 2]);
}

// Stands for a distance or coordinate that there is none of yet: the largest float. Devices need not support
// infinity.
const float kLargestFloat = 3.402823466e38;
