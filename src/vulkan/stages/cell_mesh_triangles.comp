// Finds the triangles that no other stage may read: those with an index out of range or a nonfinite vertex.
#include "vulkan/device/kernel.glsl"
#include "vulkan/device/subgroups.glsl"
#include "vulkan/stages/cell_mesh.glsl"

bool isGood(uvec3 corners) {
  if (any(greaterThanEqual(corners, uvec3(push.vertexCount)))) return false;
  return isFinite(vertexAt(corners.x)) && isFinite(vertexAt(corners.y)) && isFinite(vertexAt(corners.z));
}

bool isOutside(uvec3 corners) {
  const vec3 a = vertexAt(corners.x), b = vertexAt(corners.y), c = vertexAt(corners.z);
  return any(lessThan(min(min(a, b), c), vec3(push.low))) ||
         any(greaterThan(max(max(a, b), c), push.high));
}

// Updates the status once per subgroup.
void note(uint good, uint outside) {
  const uint first = subgroupMax(good);
  const uint outsideOfAll = subgroupAdd(outside);
  if (!subgroupElect()) return;
  if (first > 0) atomicMax(push.status.now.firstGood, first);
  if (outsideOfAll > 0) atomicAdd(push.status.now.outside, outsideOfAll);
}

// Copies a triangle, unless it is bad. Returns whether it is good.
bool copyTriangle(uint t, inout uvec3 corners) {
  corners = uvec3(push.corners.at[3 * t], push.corners.at[3 * t + 1], push.corners.at[3 * t + 2]);
  const bool isUsed = isGood(corners);
  if (!isUsed) {
    corners = uvec3(kBad);
    atomicAdd(push.status.now.bad, 1);
    atomicAdd(push.status.now.badTriangles, 1);
    atomicMax(push.status.now.firstBad, ~t);
  }
  for (uint c = 0; c < 3; ++c) push.triangles.at[3 * t + c] = corners[c];
  return isUsed;
}

void main() {
  const uint t = invocationIndex();
  uvec3 corners = uvec3(kBad);
  const bool isUsed = t < push.triangleCount && copyTriangle(t, corners);
  note(isUsed ? ~t : 0, uint(isUsed && isOutside(corners)));
}
