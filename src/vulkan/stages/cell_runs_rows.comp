// Counts the rows of cells in each triangle's bounds.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/cell_runs.glsl"

void main() {
  const uint triangle = invocationIndex();
  uint rows = 0;
  if (triangle < push.triangleCount) {
    rows = rowCount(readLocalTriangle(triangle));
    push.rowStarts.at[triangle] = rows;
  }
  addToTotal(0, rows);
}
