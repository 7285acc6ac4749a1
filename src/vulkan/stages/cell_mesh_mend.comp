// Mends bad triangles and vertices, if there are any. A bad triangle becomes a corner of a good one, which
// changes neither distances nor crossings. A bad vertex, which no triangle then uses, moves into the grid.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/cell_mesh.glsl"

void main() {
  const uint i = invocationIndex();
  if (i < push.vertexCount && !isFinite(vertexAt(i))) writeVertex(i, vec3(0));
  if (i >= push.triangleCount || push.triangles.at[3 * i] != kBad) return;
  const uint good = push.status.now.firstGood;
  const uint corner = good == 0 ? 0 : push.triangles.at[3 * ~good];
  for (uint c = 0; c < 3; ++c) push.triangles.at[3 * i + c] = corner;
}
