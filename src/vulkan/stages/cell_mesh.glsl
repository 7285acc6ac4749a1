#include "vulkan/stages/cell_mesh_push.h"

layout(push_constant, scalar) uniform Push { CellMeshPush push; };

const uint kBad = 0xffffffffu;  // Stands for a bad triangle's first corner until the triangle is mended.

vec3 vertexAt(uint v) {
  return vectorAt(push.vertices, v);
}

void writeVertex(uint v, vec3 p) {
  for (uint axis = 0; axis < 3; ++axis) push.vertices.at[3 * v + axis] = p[axis];
}

// Tests the bits, because compilers may assume that no number is infinite.
bool isFinite(vec3 p) {
  const uvec3 exponents = floatBitsToUint(p) & 0x7f800000u;
  return max(max(exponents.x, exponents.y), exponents.z) != 0x7f800000u;
}
