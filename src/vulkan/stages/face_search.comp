// Lists the edges that may be rims, and the faces that may lie on one another, for the host to look at: twin of
// the searches over all faces in mesh/rim_edges.cpp and mesh/double_sided.cpp.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "vulkan/device/kernel.glsl"
#include "base/hash_shared.h"
#include "vulkan/stages/face_search_push.h"

layout(constant_id = 1) const bool kLists = false;  // Counts first, and then lists.
layout(push_constant, scalar) uniform Push { FaceSearchPush push; };

// Returns a coordinate's bits, equal where coordinates are: -0 equals 0.
uint bitsOf(uint place) {
  const uint bits = floatBitsToUint(push.positions.at[place]);
  return bits == 0x80000000u ? 0 : bits;
}

uvec3 bitsOfCorner(uint corner) {
  const uint first = push.stride * push.corners.at[corner];
  return uvec3(bitsOf(first), bitsOf(first + 1), bitsOf(first + 2));
}

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
  const uint64_t number = mixed(min(from, to) + 3 * max(from, to));
  const uint slot = uint(number) & (push.sumCount - 1);
  if (kLists) {
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

void visitFace(uint face, uvec3 a, uvec3 b, uvec3 c) {
  const u64vec3 sum = u64vec3(a) + u64vec3(b) + u64vec3(c);  // It does not depend on the corners' order.
  const uint hash = max(uint(mixed(hashOf(sum.x, sum.y, sum.z))), 1u);
  const uint slot = hash & (push.hashCount - 1);
  if (kLists)
    listFaceOfTwo(face, hash, slot);
  else
    countFace(hash, slot);
}

void main() {
  const uint face = invocationIndex();
  if (face >= push.triangleCount) return;
  uvec3 bits[3];
  uint64_t hashes[3];
  for (uint corner = 0; corner < 3; ++corner) {
    bits[corner] = bitsOfCorner(3 * face + corner);
    hashes[corner] = mixed(hashOf(bits[corner].x, bits[corner].y, bits[corner].z));
  }
  for (uint corner = 0; corner < 3; ++corner) {
    const uint next = (corner + 1) % 3;
    if (bits[corner] != bits[next]) visitEdge(3 * face + corner, hashes[corner], hashes[next]);
  }
  visitFace(face, bits[0], bits[1], bits[2]);
}
