#pragma once

#include <raymap/buffer.h>

#include <glm/glm.hpp>

#include <cstdint>

namespace raymap {

/// §3.3, Algorithms 1 and 2 (Felzenszwalb & Huttenlocher 2012): replaces every squared value f(q) by the
/// minimum over all samples q of |p - q|^2 + f(q), along x, then y, then z, and carries the index of that q.
void transformDistance(glm::ivec3 dims, Buffer<float>& squared, Buffer<uint32_t>& nearestCell);

}  // namespace raymap
