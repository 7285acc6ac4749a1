// Lists the edges that may be rims, and the faces that may lie on one another, for the host to look at: twin of
// the searches over all faces in mesh/rim_edges.cpp and mesh/double_sided.cpp.
#include "vulkan/device/kernel.glsl"
#include "base/hash_shared.h"
#include "vulkan/stages/face_search_push.h"

layout(constant_id = 1) const uint kStep = kCountFaces;
layout(push_constant, scalar) uniform Push { FaceSearchPush push; };

void listEdge(uint edge) {
  const uint place = atomicAdd(push.counts.at[0], 1);
  if (place < push.room) push.edges.at[place] = edge;
}

void listFace(uint face) {
  const uint place = atomicAdd(push.counts.at[1], 1);
  if (place < push.room) push.faces.at[place] = face;
}

// Both directions of an edge add numbers that cancel.
void visitEdge(uint edge, uint64_t from, uint64_t to) {
  if (from == to) return;
  const uint64_t number = mixed(min(from, to) + 3 * max(from, to));
  const uint slot = uint(number) & (push.sumCount - 1);
  if (kStep == kListFaces) {
    if (push.sums.at[slot] != 0) listEdge(edge);
    return;
  }
  const uint value = uint(number >> 32) | 1u;
  atomicAdd(push.sums.at[slot], from < to ? value : 0u - value);
}

void countFace(uint hash, uint slot) {
  for (;; slot = (slot + 1) & (push.hashCount - 1)) {
    const uint found = atomicCompSwap(push.hashes.at[slot], 0, hash);
    if (found == 0) return;
    if (found == hash) break;
  }
  atomicOr(push.twice.at[slot / 32], 1u << slot % 32);
}

void listFaceOfTwo(uint face, uint hash, uint slot) {
  while (push.hashes.at[slot] != hash) slot = (slot + 1) & (push.hashCount - 1);
  if ((push.twice.at[slot / 32] >> slot % 32 & 1u) != 0) listFace(face);
}

void visitFace(uint face) {
  if (face >= push.triangleCount) return;
  uint64_t corners[3];
  for (uint c = 0; c < 3; ++c) corners[c] = push.vertexHashes.at[push.triangles.at[3 * face + c]];
  for (uint c = 0; c < 3; ++c) visitEdge(3 * face + c, corners[c], corners[(c + 1) % 3]);
  // It does not depend on the order of the corners.
  const uint hash = max(uint(mixed(corners[0] + corners[1] + corners[2])), 1u);
  const uint slot = hash & (push.hashCount - 1);
  if (kStep == kListFaces)
    listFaceOfTwo(face, hash, slot);
  else
    countFace(hash, slot);
}

void main() {
  visitFace(invocationIndex());
}
