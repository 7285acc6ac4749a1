// Joins boundary edges into loops.

#include "mesh/holes.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>

namespace raymap {

namespace {

constexpr size_t kNotOnPath = std::numeric_limits<size_t>::max();

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
    for (size_t e = 0; e < edges.size(); ++e) {
      ends.emplace_back(numberOf(edges[e].first), numberOf(edges[e].second));
      edgesAt[ends[e].first].push_back(e);
      edgesAt[ends[e].second].push_back(e);
    }
    isUsed.resize(edges.size());
  }

  size_t numberOf(uint32_t position) const {
    return size_t(std::lower_bound(positions.begin(), positions.end(), position) - positions.begin());
  }
  /// Returns the places in the order in which walks start: first those at which a chain of edges ends.
  std::vector<size_t> starts() const {
    std::vector<size_t> order(positions.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_partition(order.begin(), order.end(), [&](size_t p) { return edgesAt[p].size() % 2 != 0; });
    return order;
  }
  /// Moves `place` along an unused edge to its other end. Returns false if there is none.
  bool step(size_t& place) {
    std::vector<size_t>& edges = edgesAt[place];
    while (!edges.empty() && isUsed[edges.back()]) edges.pop_back();
    if (edges.empty()) return false;
    const size_t e = edges.back();
    isUsed[e] = true;
    place = ends[e].first == place ? ends[e].second : ends[e].first;
    return true;
  }

  std::vector<uint32_t> positions;
  std::vector<std::pair<size_t, size_t>> ends;
  std::vector<std::vector<size_t>> edgesAt;
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
  std::vector<size_t> path, placeOnPath(network.positions.size(), kNotOnPath);
  const auto cutFrom = [&](size_t first) {  // Makes a hole of the end of the path.
    std::vector<glm::dvec3> corners;
    for (size_t p = first; p < path.size(); ++p) corners.push_back(position(network.positions[path[p]]));
    if (corners.size() > 1) holes.push_back({measure(corners), network.positions[path[first]]});
    for (size_t p = first; p + 1 < path.size(); ++p) placeOnPath[path[p]] = kNotOnPath;
    path.resize(first);
  };
  for (size_t place : network.starts()) {
    path.assign(1, place);
    placeOnPath[place] = 0;
    while (network.step(place)) {
      path.push_back(place);
      if (const size_t before = placeOnPath[place]; before != kNotOnPath) {
        cutFrom(before);
        path.push_back(place);
      }
      placeOnPath[place] = path.size() - 1;
    }
    placeOnPath[path.back()] = kNotOnPath;
    cutFrom(0);
  }
  std::stable_sort(holes.begin(), holes.end(),
                   [](const TracedHole& a, const TracedHole& b) { return a.hole.length > b.hole.length; });
  return holes;
}

}  // namespace raymap
