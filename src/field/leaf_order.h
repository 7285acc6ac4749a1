#pragma once

#include <raymap/sparse_field.h>

#include "base/morton.h"

namespace raymap {

/// Returns the place on the curve of the leaf that holds a sample, for leaves and tiles in their order.
inline uint64_t placeOnCurve(const glm::ivec3& sample) {
  const glm::uvec3 leaf = glm::uvec3(sample) / uint32_t(SparseField::kLeafSide);
  return mortonCode(leaf.x, leaf.y, leaf.z);
}

}  // namespace raymap
