#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/sort_keys.h"
#include "mesh/half_edges.h"
#include "mesh/inverted_parts.h"
#include "mesh/packed_mesh.h"
#include "mesh/rim_edges.h"
#include "mesh/weld.h"

namespace raymap {

/// A mesh as all stages read it, and what is found about it: each part on first use, once. Takes one mesh
/// after another, and keeps its memory for the next. Only one thread may use it at a time.
class Model : public PackedMesh {
 public:
  Model() = default;
  explicit Model(const MeshView& view) { pack(view); }
  Model(const Model&) = delete;

  /// Refers to the view's own arrays where they are packed already; converts others. Throws `Error(Input)`
  /// for a 64-bit index out of range, `Error(Unsupported)` for more vertices than 32 bits can number.
  void pack(const MeshView& view);
  /// Does the same, but never refers to arrays of others.
  void keep(const MeshView& view);
  void keep(Mesh&& mesh);

  /// Returns the bytes that `pack` needs for a view.
  static size_t bytesNeeded(const MeshView& view);
  /// Returns the bytes of its own arrays.
  size_t bytes() const;

  const Welding& welding() const {
    return once(found_.welding, [&] { return weldVertices(vertices, keys_); });
  }
  std::span<const SortKey> halfEdges() const {
    return once(found_.halfEdges, [&] { return sortHalfEdges(*this, welding(), keys_); });
  }
  const std::vector<RimEdge>& rims(double cell) const {
    return once(found_.rims, [&] { return findRimEdges(*this, cell); });
  }
  bool mayHaveInvertedParts() const {
    return once(found_.mayHaveInvertedParts, [&] { return raymap::mayHaveInvertedParts(*this); });
  }
  /// Forgets what was found.
  void forget() { found_ = {}; }

 private:
  struct Found {
    std::optional<Welding> welding;
    std::optional<std::span<const SortKey>> halfEdges;
    std::optional<std::vector<RimEdge>> rims;
    std::optional<bool> mayHaveInvertedParts;
  };
  template <class T, class Find>
  static const T& once(std::optional<T>& known, Find&& find) {
    return known ? *known : known.emplace(find());
  }

  Buffer<glm::vec3> convertedVertices_;
  Buffer<glm::uvec3> convertedTriangles_;
  Mesh kept_;
  mutable Buffer<SortKey> keys_;
  mutable Found found_;
};

}  // namespace raymap
