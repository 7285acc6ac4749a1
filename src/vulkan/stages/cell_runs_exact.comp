// Finds the cells that a triangle touches in a row for which floats do not suffice. This is a kernel of its own because
// few rows need it, and its many values would leave room for fewer invocations at once.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/cell_runs.glsl"
#include "vulkan/stages/cell_runs_exact.glsl"

uint listRun(uint number) {
  const Row row = readRow(number, push.runTriangles.at[number]);
  return writeRun(row, findRunExactly(row.local, row.j, row.k));
}

void main() {
  const uint index = invocationIndex();
  addToTotal(2, index < push.unknownCount.at[0] ? listRun(push.unknown.at[index]) : 0);
}
