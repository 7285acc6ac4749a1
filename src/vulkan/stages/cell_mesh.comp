// Converts vertices to cell units, where sample (i, j, k) lies at (i, j, k), in double precision as the CPU does.
#include "vulkan/device/kernel.glsl"
#include "base/hash_shared.h"
#include "vulkan/primitives/soft_double.glsl"
#include "vulkan/stages/cell_mesh.glsl"

float inCells(float position, Double shift) {
  return floatOf(product(sum(shift, doubleOf(position)), push.scale));
}

// Returns a coordinate's bits, equal where coordinates are: -0 equals 0.
uint bitsOf(float coordinate) {
  const uint bits = floatBitsToUint(coordinate);
  return bits == 0x80000000u ? 0 : bits;
}

void main() {
  const uint v = invocationIndex();
  if (v >= push.vertexCount) return;
  const uint from = push.stride * v;
  const vec3 position = vec3(push.positions.at[from], push.positions.at[from + 1], push.positions.at[from + 2]);
  if (uint64_t(push.hashes) != 0)
    push.hashes.at[v] = mixed(hashOf(bitsOf(position.x), bitsOf(position.y), bitsOf(position.z)));
  vec3 vertex = position;
  if (isFinite(position))
    vertex = vec3(inCells(position.x, push.shiftX), inCells(position.y, push.shiftY), inCells(position.z, push.shiftZ));
  writeVertex(v, vertex);
  if (!isFinite(vertex)) atomicAdd(push.status.now.bad, 1);
}
