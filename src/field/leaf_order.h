#pragma once

#include <raymap/narrow_band.h>

#include "base/morton.h"

namespace raymap {

/// Returns the place on the curve of the leaf that holds a sample, for leaves and tiles in their order.
inline uint64_t placeOnCurve(const glm::ivec3& sample) {
  const glm::uvec3 leaf = glm::uvec3(sample) / uint32_t(NarrowBand::kLeafSide);
  return mortonCode(leaf.x, leaf.y, leaf.z);
}

/// Returns whether a leaf or tile comes before another: whether `placeOnCurve` is less, at less cost. The
/// axis of the highest bit that differs decides (Chan 2002).
inline bool comesBefore(const glm::ivec3& low, const glm::ivec3& other) {
  const glm::ivec3 differing = low ^ other;
  int axis = 2;
  for (const int lower : {1, 0})
    if (const int highest = differing[axis], bits = differing[lower];
        highest < bits && highest < (highest ^ bits))
      axis = lower;
  return low[axis] < other[axis];
}

}  // namespace raymap
