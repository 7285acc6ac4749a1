#extension GL_EXT_buffer_reference : require
#extension GL_EXT_scalar_block_layout : require

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Vectors { vec3 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Indices { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Depths { float at[]; };
