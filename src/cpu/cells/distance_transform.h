#pragma once

#include <raymap/buffer.h>

#include "base/progress.h"
#include "method/cell_lattice.h"

#include <glm/glm.hpp>

#include <cstdint>

namespace raymap::cpu {

/// Transforms squared distances by §3.3, Algorithms 1 and 2 (Felzenszwalb & Huttenlocher 2012). The value of
/// a cell p becomes the minimum of |p - q|^2 + f(q) over all occupied cells q, along x, then y, then z.
/// `nearestCell` gets the index of that q; of several, the one with the lowest z, then y, then x. If all
/// cells are empty, they keep `emptyCell` and get `kNoCell`.
void transformDistance(glm::ivec3 dims, Progress& progress, Buffer<float>& squared,
                       Buffer<uint32_t>& nearestCell);

}  // namespace raymap::cpu
