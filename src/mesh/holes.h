#pragma once

#include <raymap/diagnostics.h>

#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace raymap {

/// Joins edges between numbered positions into loops, the longest first. Where more than two meet, loops are
/// split off as soon as they close; what never closes (beside edges with three faces) is one hole as it is.
std::vector<Hole> traceHoles(std::span<const std::pair<uint32_t, uint32_t>> edges,
                             const std::function<glm::dvec3(uint32_t)>& position);

}  // namespace raymap
