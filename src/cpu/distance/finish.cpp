// Last stage: converts distances to the mesh's units.

#include "cpu/distance/finish.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace raymap::cpu {

void finishDistance(double band, double spacing, Buffer<float>& distance) {
  const auto scale = static_cast<float>(spacing);
  const auto limit = band > 0.0 ? static_cast<float>(band) : INFINITY;
  parallelFor(distance.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) distance[i] = std::max(-limit, std::min(distance[i], limit)) * scale;
  });
}

}  // namespace raymap::cpu
