// Joins boundary edges into loops.

#include "mesh/holes.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "mesh/loops.h"

namespace raymap {

namespace {

/// Graph of the edges. Positions with an edge are renumbered from 0.
struct Network {
  explicit Network(std::span<const std::pair<uint32_t, uint32_t>> edges) {
    for (const auto& [a, b] : edges) {
      positions.push_back(a);
      positions.push_back(b);
    }
    std::sort(positions.begin(), positions.end());
    positions.erase(std::unique(positions.begin(), positions.end()), positions.end());
    edgesAt.resize(positions.size());
    for (uint32_t e = 0; e < edges.size(); ++e) {
      ends.emplace_back(numberOf(edges[e].first), numberOf(edges[e].second));
      edgesAt[ends[e].first].push_back(e);
      edgesAt[ends[e].second].push_back(e);
    }
    isUsed.resize(edges.size());
  }

  uint32_t numberOf(uint32_t position) const {
    return uint32_t(std::lower_bound(positions.begin(), positions.end(), position) - positions.begin());
  }
  /// Returns the places in the order in which walks start: first those at which a chain of edges ends.
  std::vector<uint32_t> starts() const {
    std::vector<uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_partition(order.begin(), order.end(), [&](uint32_t p) { return edgesAt[p].size() % 2 != 0; });
    return order;
  }
  /// Moves `place` along an unused edge to its other end. Returns the edge.
  uint32_t take(uint32_t& place) {
    std::vector<uint32_t>& edges = edgesAt[place];
    while (!edges.empty() && isUsed[edges.back()]) edges.pop_back();
    if (edges.empty()) return kNoEdge;
    const uint32_t e = edges.back();
    isUsed[e] = true;
    place = ends[e].first == place ? ends[e].second : ends[e].first;
    return e;
  }

  std::vector<uint32_t> positions;
  std::vector<std::pair<uint32_t, uint32_t>> ends;
  std::vector<std::vector<uint32_t>> edgesAt;
  std::vector<bool> isUsed;
};

Hole measure(std::span<const glm::dvec3> corners) {
  Hole hole{.edges = corners.size() - 1};
  for (size_t c = 0; c + 1 < corners.size(); ++c) {
    const double length = glm::distance(corners[c], corners[c + 1]);
    hole.length += length;
    hole.centre += 0.5 * length * (corners[c] + corners[c + 1]);
  }
  hole.centre = hole.length > 0.0 ? hole.centre / hole.length : corners[0];
  glm::dvec3 twiceArea(0.0);
  for (size_t c = 0; c < corners.size(); ++c)  // A chain that does not close is closed by a straight line.
    twiceArea += glm::cross(corners[c] - hole.centre, corners[(c + 1) % corners.size()] - hole.centre);
  hole.area = glm::length(twiceArea) / 2.0;
  for (const glm::dvec3& corner : corners)
    hole.diameter = std::max(hole.diameter, 2.0 * glm::distance(corner, hole.centre));
  return hole;
}

}  // namespace

std::vector<TracedHole> traceHoles(std::span<const std::pair<uint32_t, uint32_t>> edges,
                                   const std::function<glm::dvec3(uint32_t)>& position) {
  Network network(edges);
  std::vector<TracedHole> holes;
  const auto add = [&](std::span<const LoopStep> steps, uint32_t end) {
    const auto at = [&](uint32_t place) { return position(network.positions[place]); };
    std::vector<glm::dvec3> corners;
    for (const LoopStep& step : steps) corners.push_back(at(step.from));
    corners.push_back(at(end));
    holes.push_back({measure(corners), network.positions[steps[0].from]});
  };
  traceLoops(
      network.positions.size(), network.starts(), [&](uint32_t& place) { return network.take(place); }, add);
  std::stable_sort(holes.begin(), holes.end(),
                   [](const TracedHole& a, const TracedHole& b) { return a.hole.length > b.hole.length; });
  return holes;
}

}  // namespace raymap
