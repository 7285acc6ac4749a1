// Converts vertices to cell units, where sample (i, j, k) lies at (i, j, k). Double precision gives exactly
// the CPU's result.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/cell_mesh.glsl"

void main() {
  const uint v = invocationIndex();
  if (v >= push.vertexCount) return;
  const uint from = push.stride * v;
  const dvec3 position = dvec3(push.positions.at[from], push.positions.at[from + 1], push.positions.at[from + 2]);
  precise const dvec3 fromOrigin = dvec3(push.shiftX, push.shiftY, push.shiftZ) + position;
  precise const dvec3 cells = fromOrigin * push.scale;
  const vec3 vertex = vec3(cells);
  writeVertex(v, vertex);
  if (!isFinite(vertex)) atomicAdd(push.status.now.bad, 1);
}
