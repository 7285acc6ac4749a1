// Finds the first entry of each cell; the entries are sorted by cell.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/voxel_grid_push.h"

layout(push_constant, scalar) uniform Push { VoxelGridPush push; };

void main() {
  const uint entry = invocationIndex(), count = push.count.at[0];
  if (entry >= count) return;
  const uint cell = push.cells.at[entry];
  if (entry == 0 || push.cells.at[entry - 1] != cell) push.begins.at[cell] = entry;
}
