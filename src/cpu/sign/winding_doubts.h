#pragma once

#include "cpu/sign/crossings.h"
#include "method/winding_doubts_shared.h"

namespace raymap::cpu {

/// Returns the samples of a grid whose winding number may lie on the wrong side of the threshold, ascending.
/// `distance` is the unsigned distance in cells, and `source` is what the numbers come from.
std::vector<uint32_t> findDoubts(const glm::ivec3& dims, const Crossings& crossings,
                                 const Buffer<float>& winding, const Buffer<float>& distance, uint32_t source,
                                 double threshold);

}  // namespace raymap::cpu
