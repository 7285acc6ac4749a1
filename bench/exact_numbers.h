#pragma once

#include "base/parallel.h"
#include "testing/reference.h"
#include "testing/sign_scene.h"

namespace raymap::bench {

/// Returns the exact generalized winding number at every `stride`-th sample.
inline std::vector<double> exactNumbers(const Mesh& mesh, const Grid& grid, size_t stride) {
  std::vector<double> exact((grid.sampleCount() + stride - 1) / stride);
  parallelFor(exact.size(), 64, [&](size_t begin, size_t end) {
    for (size_t e = begin; e < end; ++e)
      exact[e] = reference::windingNumber(mesh, samplePosition(grid, e * stride));
  });
  return exact;
}

}  // namespace raymap::bench
