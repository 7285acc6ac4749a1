// Krayer & Müller 2019, §3.5: the six rays, averaged.

#include "cpu/sign/winding_rays.h"

#include <atomic>

namespace raymap::cpu {

namespace {

/// Averages the rays of a row (Eq. 7). Returns the number of samples whose rays disagree. Along each axis, r
/// is the ray to plus infinity; r minus the line's total is the ray to minus infinity. Our sign counts +1 for
/// leaving through a face in either direction.
size_t averageRow(const RayRow& row, size_t count, float* winding) {
  uint32_t doubtful = 0;
  for (size_t i = 0; i < count; ++i) {
    const int32_t x = row.x[i], y = row.y[i], z = row.z[i];
    const int32_t totalY = row.totalY[i], totalZ = row.totalZ[i];
    const int32_t sum = 2 * (x + y + z) - (row.totalX + totalY + totalZ);
    doubtful += ((x ^ y) | (y ^ z) | row.totalX | totalY | totalZ) != 0 ? 1u : 0u;
    winding[i] = float(sum) / 6.0f;
  }
  return doubtful;
}

}  // namespace

size_t averageRays(const RaySweep& sweep, Buffer<float>& winding) {
  std::atomic<size_t> doubtful{0};
  winding.resizeUninitialized(sweep.sampleCount());
  sweep.run([&](const RayRow& row) {
    const size_t found = averageRow(row, sweep.rowLength(), winding.data() + row.first);
    if (found) doubtful.fetch_add(found, std::memory_order_relaxed);
  });
  return doubtful;
}

}  // namespace raymap::cpu
