#include "mesh/rim_edges.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/sort_keys.h"
#include "mesh/position_bits.h"

namespace raymap {

namespace {

constexpr size_t kRimFacesPerTask = 4096;

/// Edges add these hashes, so all of their bits must be mixed well.
uint64_t mixedHashOf(const glm::vec3& p) {
  return mixed(hashOf(p));
}

/// A directed edge by the hashes of its ends: a number that is the same in both directions, and its
/// direction, +1 or -1; 0 if both ends are the same.
struct Edge {
  Edge(uint64_t from, uint64_t to)
      : number(mixed(std::min(from, to) + 3 * std::max(from, to))),
        direction(int(from < to) - int(from > to)) {}

  uint64_t number;
  int direction;
};

std::pair<uint32_t, uint32_t> endsOf(const PackedMesh& mesh, size_t edge) {
  const glm::uvec3& face = mesh.triangles[edge / 3];
  const int corner = int(edge % 3);
  return {face[corner], face[(corner + 1) % 3]};
}

/// An edge with a place that near edges share.
struct PlacedEdge : Edge {
  uint32_t place;
};

/// All edges of a mesh.
class Edges {
 public:
  Edges(const PackedMesh& mesh, double cell)
      : mesh_(mesh), hashes_(mesh.vertices.size()), places_(mesh.vertices.size()) {
    const auto cells = static_cast<float>(1.0 / cell);
    parallelFor(mesh.vertices.size(), kRimFacesPerTask, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) {
        constexpr float kRound = 1.5f * (1 << 23);  // The sum has no fraction.
        hashes_[v] = mixedHashOf(mesh.vertices[v]);
        places_[v] = static_cast<uint32_t>(mixedHashOf(mesh.vertices[v] * cells + kRound));
      }
    });
  }

  size_t count() const { return 3 * mesh_.triangles.size(); }
  PlacedEdge operator[](size_t k) const {
    const auto [from, to] = endsOf(mesh_, k);
    const uint64_t a = hashes_[from], b = hashes_[to];
    return {{a, b}, places_[a < b ? from : to]};
  }

 private:
  const PackedMesh& mesh_;
  Buffer<uint64_t> hashes_;  // of the vertices' positions
  Buffer<uint32_t> places_;  // hashes of their cells
};

/// Sums that are 0 where all edges end evenly. Several edges share one. Sums of edges of the same cell mostly
/// lie in one cache line. The upper half of an edge's number keeps edges from cancelling each other by
/// chance.
class EdgeSums {
 public:
  explicit EdgeSums(size_t faces) : lines_(faces / (2 * kLine) + 4), sums_(lines_ * kLine) {}

  void add(const PlacedEdge& edge) {
    const auto value = static_cast<uint32_t>(edge.number >> 32) | 1u;
    at(edge).fetch_add(value * static_cast<uint32_t>(edge.direction), std::memory_order_relaxed);
  }
  bool mayBeRim(const PlacedEdge& edge) {
    return (edge.direction != 0) & (at(edge).load(std::memory_order_relaxed) != 0);
  }
  bool hasRims() const {
    return std::ranges::any_of(sums_,
                               [](const auto& sum) { return sum.load(std::memory_order_relaxed) != 0; });
  }

 private:
  std::atomic<uint32_t>& at(const PlacedEdge& edge) {
    return sums_[(edge.place * lines_ >> 32) * kLine + edge.number % kLine];
  }

  static constexpr uint64_t kLine = 64 / sizeof(uint32_t);  // of the cache
  uint64_t lines_;
  std::vector<std::atomic<uint32_t>> sums_;
};

void addEdges(const Edges& edges, EdgeSums& sums) {
  parallelFor(edges.count(), 3 * kRimFacesPerTask, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) sums.add(edges[k]);
  });
}

}  // namespace

std::vector<RimEdge> findRimEdges(const PackedMesh& mesh, double cell) {
  const Edges edges(mesh, cell);
  EdgeSums sums(mesh.triangles.size());
  addEdges(edges, sums);
  if (!sums.hasRims()) return {};
  return findRimEdges(mesh,
                      parallelSelect(edges.count(), [&](uint32_t k) { return sums.mayBeRim(edges[k]); }));
}

std::vector<RimEdge> findRimEdges(const PackedMesh& mesh, std::span<const uint32_t> candidates) {
  const auto edgeOf = [&](uint32_t k) -> Edge {
    const auto [from, to] = endsOf(mesh, k);
    return {mixedHashOf(mesh.vertices[from]), mixedHashOf(mesh.vertices[to])};
  };
  Buffer<SortKey> keys;
  const auto make = [&](size_t begin, size_t end, SortKey* to) {
    for (size_t i = begin; i < end; ++i) {
      const Edge edge = edgeOf(candidates[i]);
      *to++ = {uint64_t{candidates[i]} << 1 | uint64_t{edge.direction > 0}, edge.number};
    }
  };
  sortKeys(candidates.size(), make, keys);
  std::vector<RimEdge> rims;
  for (size_t first = 0, next = 0; first < keys.size(); first = next) {
    int64_t sum = 0;  // The other direction counts negative.
    for (; next < keys.size() && keys[next].high == keys[first].high; ++next)
      sum += ((keys[next].low ^ keys[first].low) & 1) == 0 ? 1 : -1;
    const auto [from, to] = endsOf(mesh, keys[first].low >> 1);
    if (sum > 0) rims.push_back({from, to, uint32_t(sum)});
    if (sum < 0) rims.push_back({to, from, uint32_t(-sum)});
  }
  return rims;
}

}  // namespace raymap
