// Ours, after Krayer & Müller 2019, §3.5: the field says which way the faces point.

#include "cpu/sign/orientation.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "cpu/sign/crossings_lines.h"
#include "cpu/sign/ray_sweep.h"
#include "method/orientation_shared.h"

namespace raymap::cpu {

namespace {

struct Misfit {
  double squares = 0.0, jumps = 0.0;
};

/// Returns the number of a sample's six rays that cross an odd number of faces. A sum of +1 and -1 is odd
/// exactly if their number is odd.
int oddRays(const RayRow& row, size_t i) {
  const auto odd = [](int32_t ray) { return ray & 1; };
  return odd(row.x[i]) + odd(row.x[i] - row.totalX) + odd(row.y[i]) + odd(row.y[i] - row.totalY[i]) +
         odd(row.z[i]) + odd(row.z[i] - row.totalZ[i]);
}

}  // namespace

/// The field fits as well as possible, so the residual is orthogonal to all differences of fields. Its square
/// is then its product with the jumps, and only crossed edges matter.
double measureMisfit(const glm::ivec3& dims, const Crossings& crossings, const Buffer<float>& winding) {
  const auto add = [&](Misfit& sum, const CrossedEdge& edge) {
    const double jump = edge.signedCount;
    sum.squares += jump * (jump - (double(winding[edge.from]) - double(winding[edge.to])));
    sum.jumps += std::abs(jump);
  };
  Misfit sum;
  for (const Misfit& part : sumCrossedEdges<Misfit>(dims, crossings, add)) {
    sum.squares += part.squares;
    sum.jumps += part.jumps;
  }
  return sum.jumps > 0.0 ? sum.squares / sum.jumps : 0.0;
}

bool contradictsParity(const RayMap& map, const Buffer<float>& winding, double threshold) {
  const RaySweep sweep(map);
  const auto limit = static_cast<float>(threshold);
  std::atomic<bool> does = false;
  sweep.run([&](const RayRow& row) {
    if (does) return;
    const float* const w = winding.data() + row.first;
    int32_t found = 0;
    for (size_t i = 0; i < sweep.rowLength(); ++i) {  // Without branches the compiler vectorizes the loop.
      const int32_t a = row.x[i], b = a - row.totalX, c = row.y[i], d = c - row.totalY[i], e = row.z[i],
                    f = e - row.totalZ[i];
      const int32_t allOdd = a & b & c & d & e & f & 1, allEven = ~(a | b | c | d | e | f) & 1;
      const float excess = std::abs(w[i]) - limit;
      const int32_t isSure = std::abs(excess) > kSureSign ? 1 : 0;
      found |= isSure & (excess > 0.0f ? allEven : allOdd);
    }
    if (found != 0) does = true;
  });
  return does;
}

void averageParity(const RayMap& map, Buffer<float>& parity) {
  const RaySweep sweep(map);
  parity.resizeUninitialized(sweep.sampleCount());
  sweep.run([&](const RayRow& row) {
    for (size_t i = 0; i < sweep.rowLength(); ++i) parity[row.first + i] = float(oddRays(row, i)) / 6.0f;
  });
}

}  // namespace raymap::cpu
