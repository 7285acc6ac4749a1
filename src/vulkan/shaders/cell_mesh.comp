// Vertices in cell units, where sample (i, j, k) lies at (i, j, k): in double precision, exactly as the CPU does.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernel.glsl"
#include "shared/cell_mesh.h"

layout(push_constant, scalar) uniform Push { CellMeshPush push; };

void main() {
  const uint v = invocationIndex();
  if (v >= push.count) return;
  const dvec3 position =
      dvec3(push.positions.at[3 * v], push.positions.at[3 * v + 1], push.positions.at[3 * v + 2]);
  precise const dvec3 fromOrigin = dvec3(push.shiftX, push.shiftY, push.shiftZ) + position;
  precise const dvec3 cells = fromOrigin * push.scale;
  for (uint axis = 0; axis < 3; ++axis) push.vertices.at[3 * v + axis] = float(cells[axis]);
}
