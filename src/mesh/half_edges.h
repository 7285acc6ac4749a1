#pragma once

#include <cstdint>
#include <span>

#include "base/sort_keys.h"
#include "mesh/packed_mesh.h"
#include "mesh/weld.h"

namespace raymap {

/// One face's side of an edge between two distinct positions.
struct HalfEdge {
  uint32_t low, high;
  uint32_t face;
  uint32_t thirdBits;  ///< Lowest 31 bits of the face's third corner.
  bool isForward;      ///< Whether the face runs from `low` to `high`.

  uint32_t from() const { return isForward ? low : high; }
  uint32_t to() const { return isForward ? high : low; }
};

/// Half edges as keys: by `low`, then by `high`, then by face.
inline SortKey halfEdgeKey(const HalfEdge& edge) {
  return {uint64_t{edge.face} << 32 | uint64_t{edge.thirdBits & 0x7fffffff} << 1 | uint64_t{edge.isForward},
          uint64_t{edge.low} << 32 | edge.high};
}
inline HalfEdge halfEdgeOf(const SortKey& key) {
  return {uint32_t(key.high >> 32), uint32_t(key.high), uint32_t(key.low >> 32),
          uint32_t(key.low >> 1) & 0x7fffffff, (key.low & 1) != 0};
}

/// Returns the keys of all half edges, those of an edge together, faces ascending. Faces with a repeated
/// corner have none. Uses the memory of `keys`.
std::span<const SortKey> sortHalfEdges(const PackedMesh& mesh, const Welding& welding, Buffer<SortKey>& keys);

/// Returns the first place from `k` on at which an edge's keys begin.
inline size_t edgeStart(std::span<const SortKey> keys, size_t k) {
  while (k > 0 && k < keys.size() && keys[k].high == keys[k - 1].high) ++k;
  return k;
}

/// Calls `work(keys)` with the keys of each edge that begins in [begin, end).
template <class Work>
void forEachEdge(std::span<const SortKey> keys, size_t begin, size_t end, Work&& work) {
  for (size_t first = edgeStart(keys, begin); first < end;) {
    const size_t next = edgeStart(keys, first + 1);
    work(keys.subspan(first, next - first));
    first = next;
  }
}

}  // namespace raymap
