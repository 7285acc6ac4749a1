// Ours, after Krayer & Müller 2019, §3.5: where many faces end, the field cannot follow the crossings.

#include "cpu/sign/winding_doubts.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cpu/sign/crossings_lines.h"

namespace raymap::cpu {

namespace {

/// Returns the largest change of the numbers along a crossed edge, apart from its crossings.
float largestChange(const glm::ivec3& dims, const Crossings& crossings, const Buffer<float>& winding) {
  const std::vector<float> changes =
      sumCrossedEdges<float>(dims, crossings, [&](float& largest, const CrossedEdge& edge) {
        const float fall = winding[edge.from] - winding[edge.to];
        largest = std::max(largest, std::abs(static_cast<float>(edge.signedCount) - fall));
      });
  return changes.empty() ? 0.0f : std::ranges::max(changes);
}

}  // namespace

std::vector<uint32_t> findDoubts(const glm::ivec3& dims, const Crossings& crossings,
                                 const Buffer<float>& winding, const Buffer<float>& distance, uint32_t source,
                                 double threshold) {
  const float limit = static_cast<float>(threshold), change = largestChange(dims, crossings, winding);
  return parallelSelect(
      winding.size(), [&](uint32_t s) { return isDoubtful(winding[s], limit, source, distance[s], change); });
}

}  // namespace raymap::cpu
