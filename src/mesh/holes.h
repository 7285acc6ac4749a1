#pragma once

#include <raymap/diagnostics.h>

#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace raymap {

/// A boundary loop and one of the positions on it.
struct TracedHole {
  Hole hole;
  uint32_t position;
};

/// Joins edges between numbered positions into boundary loops, the longest first. Where more than two edges
/// meet, a loop is split off as soon as it closes. A chain that never closes, beside edges with three faces,
/// is one hole.
std::vector<TracedHole> traceHoles(std::span<const std::pair<uint32_t, uint32_t>> edges,
                                   const std::function<glm::dvec3(uint32_t)>& position);

}  // namespace raymap
