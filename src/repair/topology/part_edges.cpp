#include "repair/topology/part_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "mesh/half_edges.h"

namespace raymap {

namespace {

constexpr double kStep = 1e-3;      // Share of the way to the middle of the faces,
constexpr double kRounding = 1e-6;  // or of the mesh's size if that is more,
constexpr double kMost = 0.1;       // but at most this share of the way.

/// A face at an edge.
struct Leaf {
  double angle;  ///< Around the edge.
  glm::dvec3 inward;
  HalfEdge side;
};

/// Cuts the faces at one edge after the other. A face is cut once; the rest of it waits for the next round.
class EdgeParter {
 public:
  EdgeParter(Mesh& mesh, std::vector<uint32_t>& sources)
      : mesh_(mesh), sources_(sources), isCut_(mesh.triangles.size()) {
    const glm::dvec3 size = bounds(mesh).size();
    least_ = kRounding * std::max({size.x, size.y, size.z});
  }

  /// Returns whether an edge was cut.
  bool part() {
    Buffer<SortKey> keys;
    const std::span<const SortKey> halfEdges = sortHalfEdges(mesh_, unwelded(mesh_.vertices.size()), keys);
    const size_t before = mesh_.triangles.size();
    forEachEdge(halfEdges, 0, halfEdges.size(), [&](std::span<const SortKey> edge) {
      if (edge.size() > 2) partAt(edge);
    });
    return mesh_.triangles.size() > before;
  }

 private:
  glm::dvec3 at(uint32_t vertex) const { return glm::dvec3(mesh_.vertices[vertex]); }
  uint32_t thirdOf(const HalfEdge& side) const {
    const glm::uvec3& t = mesh_.triangles[side.face];
    return t.x ^ t.y ^ t.z ^ side.low ^ side.high;
  }

  void partAt(std::span<const SortKey> edge) {
    const HalfEdge first = halfEdgeOf(edge[0]);
    const glm::dvec3 low = at(first.low), along = glm::normalize(at(first.high) - low);
    std::vector<Leaf> leaves;
    glm::dvec3 u(0.0);
    for (const SortKey& key : edge) {
      const HalfEdge side = halfEdgeOf(key);
      if (isCut_[side.face]) return;
      glm::dvec3 inward = at(thirdOf(side)) - low;
      inward -= glm::dot(inward, along) * along;
      if (!(glm::length(inward) > 0.0)) return;
      if (leaves.empty()) u = glm::normalize(inward);
      const double angle = std::atan2(glm::dot(inward, glm::cross(along, u)), glm::dot(inward, u));
      leaves.push_back({angle, inward, side});
    }
    std::ranges::stable_sort(leaves, {}, &Leaf::angle);
    // Each solid lies between a face that runs down and the next one, which runs up.
    if (leaves[0].side.isForward) std::rotate(leaves.begin(), leaves.begin() + 1, leaves.end());
    for (size_t k = 0; k < leaves.size(); ++k)
      if (leaves[k].side.isForward != (k % 2 == 1)) return;
    for (size_t k = 0; k < leaves.size(); k += 2) partBetween(leaves[k], leaves[k + 1]);
  }

  void partBetween(const Leaf& a, const Leaf& b) {
    double angle = b.angle - a.angle;
    if (angle <= 0.0) angle += 2.0 * std::numbers::pi;
    const glm::dvec3 low = at(a.side.low), high = at(a.side.high),
                     towards = glm::cross(glm::normalize(high - low), a.inward) / glm::length(a.inward),
                     middle =
                         std::cos(0.5 * angle) * glm::normalize(a.inward) + std::sin(0.5 * angle) * towards;
    const double reach = std::min({glm::length(a.inward), glm::length(b.inward), glm::length(high - low)}),
                 step = std::min(std::max(kStep * reach, least_), kMost * reach);
    const auto point = uint32_t(mesh_.vertices.size());
    mesh_.vertices.emplace_back(0.5 * (low + high) + step * middle);
    for (const HalfEdge& side : {a.side, b.side}) {
      const uint32_t third = thirdOf(side);
      mesh_.triangles[side.face] = {side.from(), point, third};
      mesh_.triangles.emplace_back(point, side.to(), third);
      sources_.push_back(sources_[side.face]);
      isCut_[side.face] = true;
    }
  }

  Mesh& mesh_;
  std::vector<uint32_t>& sources_;
  std::vector<bool> isCut_;
  double least_;  ///< Least distance of a new point from its edge, which rounding keeps.
};

}  // namespace

size_t partEdges(Mesh& mesh, std::vector<uint32_t>& sources) {
  const size_t before = mesh.triangles.size();
  constexpr int kMostRounds = 4;  // A face may have several such edges.
  for (int round = 0; round < kMostRounds && EdgeParter(mesh, sources).part(); ++round) {
  }
  return mesh.triangles.size() - before;  // Each cut makes one face more.
}

}  // namespace raymap
