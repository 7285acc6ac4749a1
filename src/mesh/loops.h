#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace raymap {

/// A step of a walk along edges.
struct LoopStep {
  uint32_t from;  ///< Place where the step starts.
  uint32_t edge;
};

inline constexpr uint32_t kNoEdge = UINT32_MAX;

/// Joins edges between numbered places into loops. Walks from each of `starts` until `take(place)` finds no
/// edge. A loop is split off as soon as it closes. `take` moves `place` along an edge that no walk has used,
/// and returns this edge, or `kNoEdge`. Calls `visit(steps, end)` for each loop, and for what is left of a
/// walk that ends elsewhere than it starts.
template <class Take, class Visit>
void traceLoops(size_t places, std::span<const uint32_t> starts, Take&& take, Visit&& visit) {
  constexpr size_t kNotOnPath = SIZE_MAX;
  std::vector<size_t> stepAt(places, kNotOnPath);
  std::vector<LoopStep> path;
  const auto cutFrom = [&](size_t first, uint32_t end) {
    visit(std::span<const LoopStep>(path).subspan(first), end);
    for (size_t s = first; s < path.size(); ++s) stepAt[path[s].from] = kNotOnPath;
    path.resize(first);
  };
  for (const uint32_t start : starts) {
    uint32_t place = start;
    for (;;) {
      const uint32_t from = place, edge = take(place);
      if (edge == kNoEdge) break;
      stepAt[from] = path.size();
      path.push_back({from, edge});
      if (stepAt[place] != kNotOnPath) cutFrom(stepAt[place], place);
    }
    if (!path.empty()) cutFrom(0, place);
  }
}

}  // namespace raymap
