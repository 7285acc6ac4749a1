// Writes each pair to the list of its cell.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/voxel_grid_push.h"

layout(push_constant, scalar) uniform Push { VoxelGridListsPush push; };

void main() {
  const uint pair = push.firstGroup * gl_WorkGroupSize.x + invocationIndex();
  if (pair >= push.totals.at[kEntriesWord]) return;
  const uint cell = push.cells.at[pair], entry = push.begins.at[cell] + push.places.at[pair];
  push.entryCells.at[entry] = cell;
  push.entryTriangles.at[entry] = push.touching.at[pair];
}
