#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

inline constexpr uint32_t kNoIndex = UINT32_MAX;

/// A closed manifold mesh whose edges can be collapsed, and whose collapses can be undone in any order: those
/// of the neighbourhood that came later are undone first. Half edge 3f + k runs from corner k of face f to
/// the next one. A collapse is named by the vertex that it removes.
class CollapsibleMesh {
 public:
  static constexpr uint32_t kMostValence = 24;

  /// Half edges that leave a vertex, in order around it.
  struct Ring {
    std::array<uint32_t, kMostValence> all;
    uint32_t count = 0;

    std::span<const uint32_t> edges() const { return {all.data(), count}; }
  };

  /// Throws `Error(Input)` if the mesh is not a closed, oriented manifold.
  explicit CollapsibleMesh(const PackedMesh& mesh);

  uint32_t vertexCount() const { return uint32_t(outgoing_.size()); }
  uint32_t faceCount() const { return uint32_t(isDead_.size()); }
  /// Returns whether a face uses the vertex.
  bool hasVertex(uint32_t v) const { return outgoing_[v] != kNoIndex; }
  bool hasFace(uint32_t f) const { return isDead_[f] == 0; }
  uint32_t from(uint32_t h) const { return corner_[h]; }
  uint32_t to(uint32_t h) const { return corner_[next(h)]; }
  uint32_t opposite(uint32_t h) const { return corner_[previous(h)]; }
  uint32_t twin(uint32_t h) const { return twin_[h]; }
  glm::uvec3 face(uint32_t f) const { return {corner_[3 * f], corner_[3 * f + 1], corner_[3 * f + 2]}; }

  /// Finds the ring of a vertex that a face uses. Returns false if it has more than `kMostValence` edges.
  bool findRing(uint32_t v, Ring& ring) const;

  /// Makes room for the records of `count` tasks that collapse edges at the same time. Returns the first.
  uint32_t addRecords(size_t count);

  /// Returns whether the mesh stays a manifold if the edge between two vertices with these rings collapses.
  bool canCollapse(const Ring& ring, const Ring& other) const;
  /// Moves all faces around a vertex to the end of its half edge `ring.all[k]`, and drops the two at this
  /// edge. Tasks may do so at the same time where the rings of both ends are theirs alone.
  void collapse(const Ring& ring, uint32_t k, uint32_t record);

  /// Returns the vertex that the last collapse at a face removed, or `kNoIndex`.
  uint32_t lastCollapse(uint32_t f) const { return lastCollapse_[f]; }
  /// Undoes a collapse. Calls `restored(v)` for it, and before for each later one that must be undone.
  template <class Restored>
  void undo(uint32_t v, Restored&& restored) {
    std::vector<uint32_t> waiting = {v};
    while (!waiting.empty()) {
      const uint32_t last = waiting.back(), later = laterCollapse(last);
      if (later != kNoIndex) {
        waiting.push_back(later);
        continue;
      }
      waiting.pop_back();
      restore(last);
      restored(last);
    }
  }

 private:
  /// A face that a collapse changed, and the collapse that changed it before.
  struct Touch {
    uint32_t face, before;
  };
  /// Place of a collapse in the record.
  struct Place {
    uint32_t record, first, count;
    uint32_t edge;  ///< The half edge that collapsed.
  };

  static uint32_t next(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static uint32_t previous(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

  void link(const PackedMesh& mesh);
  void touch(const Ring& ring, uint32_t k, uint32_t record);
  uint32_t laterCollapse(uint32_t v) const;
  void restore(uint32_t v);
  std::span<const Touch> touches(uint32_t v) const {
    return std::span(records_[places_[v].record]).subspan(places_[v].first, places_[v].count);
  }

  std::vector<uint32_t> corner_, twin_;  // Per half edge. Dropped faces keep theirs.
  std::vector<uint32_t> outgoing_;       // A half edge that leaves the vertex.
  std::vector<uint8_t> isDead_;          // Per face.
  std::vector<uint32_t> lastCollapse_;   // Per face.
  std::vector<Place> places_;            // Per vertex.
  std::vector<std::vector<Touch>> records_;
};

}  // namespace raymap
