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

/// A sum for each vertex that is 0 where all edges there are passed as often in both directions. Vertices at
/// the same position share one, and so may others. Those of the same cell mostly lie in one cache line.
class VertexSums {
 public:
  VertexSums(const PackedMesh& mesh, double cell)
      : lines_(mesh.vertices.size() / kLine + 1), ends_(mesh.vertices.size()), sums_(lines_ * kLine) {
    const auto cells = static_cast<float>(1.0 / cell);
    parallelFor(mesh.vertices.size(), kRimFacesPerTask, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) {
        constexpr float kRound = 1.5f * (1 << 23);  // The sum has no fraction.
        const uint64_t hash = mixedHashOf(mesh.vertices[v]);
        const uint64_t place = mixedHashOf(mesh.vertices[v] * cells + kRound) >> 32;
        ends_[v] = {uint32_t((place * lines_ >> 32) * kLine + hash % kLine), uint32_t(hash >> 32),
                    uint32_t(hash) | 1};
      }
    });
    parallelFor(mesh.triangles.size(), kRimFacesPerTask, [&](size_t begin, size_t end) {
      for (size_t f = begin; f < end; ++f) add(mesh.triangles[f]);
    });
  }

  bool areZero() const {
    return std::ranges::all_of(sums_,
                               [](const auto& sum) { return sum.load(std::memory_order_relaxed) == 0; });
  }
  /// Returns whether an edge that is not passed as often in both directions may end at the vertex.
  bool mayBeAtRim(uint32_t vertex) const {
    return sums_[ends_[vertex].sum].load(std::memory_order_relaxed) != 0;
  }

 private:
  struct End {
    uint32_t sum;   // the place of the vertex's sum
    uint32_t hash;  // what it adds to the sums of others
    // Factor of what its own sum gets. Without it, the three of a face cancel where they share a sum.
    uint32_t weight;
  };

  /// At each vertex, adds the next one and takes away the one before.
  void add(const glm::uvec3& face) {
    const End a = ends_[face.x], b = ends_[face.y], c = ends_[face.z];
    sums_[a.sum].fetch_add(a.weight * (b.hash - c.hash), std::memory_order_relaxed);
    sums_[b.sum].fetch_add(b.weight * (c.hash - a.hash), std::memory_order_relaxed);
    sums_[c.sum].fetch_add(c.weight * (a.hash - b.hash), std::memory_order_relaxed);
  }

  static constexpr uint64_t kLine = 64 / sizeof(uint32_t);  // of the cache
  uint64_t lines_;
  Buffer<End> ends_;
  std::vector<std::atomic<uint32_t>> sums_;
};

}  // namespace

std::vector<RimEdge> findRimEdges(const PackedMesh& mesh, double cell) {
  const VertexSums sums(mesh, cell);
  if (sums.areZero()) return {};
  const auto mayBeRim = [&](uint32_t edge) {
    const auto [from, to] = endsOf(mesh, edge);
    return sums.mayBeAtRim(from) && sums.mayBeAtRim(to) && mesh.vertices[from] != mesh.vertices[to];
  };
  const std::vector<uint32_t> faces = parallelSelect(
      mesh.triangles.size(),
      [&](uint32_t face) {
        const glm::uvec3& corners = mesh.triangles[face];
        return int(sums.mayBeAtRim(corners.x)) + int(sums.mayBeAtRim(corners.y)) +
                   int(sums.mayBeAtRim(corners.z)) >
               1;
      },
      kRimFacesPerTask);
  std::vector<uint32_t> candidates;
  for (const uint32_t face : faces)
    for (uint32_t edge = 3 * face; edge < 3 * face + 3; ++edge)
      if (mayBeRim(edge)) candidates.push_back(edge);
  return findRimEdges(mesh, candidates);
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
    int64_t sum = 0;  // The other direction is negative.
    for (; next < keys.size() && keys[next].high == keys[first].high; ++next)
      sum += ((keys[next].low ^ keys[first].low) & 1) == 0 ? 1 : -1;
    const auto [from, to] = endsOf(mesh, keys[first].low >> 1);
    if (sum > 0) rims.push_back({from, to, uint32_t(sum)});
    if (sum < 0) rims.push_back({to, from, uint32_t(-sum)});
  }
  return rims;
}

}  // namespace raymap
