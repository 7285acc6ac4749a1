// Krayer & Müller 2019, §3.5: the six rays, averaged, or one of them.

#include "cpu/sign/winding_rays.h"

#include <atomic>

namespace raymap::cpu {

namespace {

/// Fills in the winding numbers of a row (Eq. 7). Returns the number of samples whose rays disagree. Along
/// each axis, r is the ray to plus infinity; r minus the line's total is the ray to minus infinity. Our sign
/// adds +1 for leaving through a face in either direction.
template <bool kIsOneRay>
size_t fillRow(const RayRow& row, size_t count, float* winding) {
  uint32_t doubtful = 0;
  for (size_t i = 0; i < count; ++i) {
    const int32_t x = row.x[i], y = row.y[i], z = row.z[i];
    const int32_t totalY = row.totalY[i], totalZ = row.totalZ[i];
    const int32_t sum = 2 * (x + y + z) - (row.totalX + totalY + totalZ);
    doubtful += ((x ^ y) | (y ^ z) | row.totalX | totalY | totalZ) != 0 ? 1u : 0u;
    winding[i] = kIsOneRay ? float(x) : float(sum) / 6.0f;
  }
  return doubtful;
}

template <bool kIsOneRay>
size_t fillRows(const RaySweep& sweep, Progress& progress, double end, Buffer<float>& winding) {
  std::atomic<size_t> doubtful{0};
  const glm::ivec3& dims = sweep.map().dims;
  WorkMeter planes(progress, 0.0, end, dims.z);
  winding.resizeUninitialized(sweep.sampleCount());
  sweep.run([&](const RayRow& row) {
    const size_t found = fillRow<kIsOneRay>(row, sweep.rowLength(), winding.data() + row.first);
    if (found) doubtful.fetch_add(found, std::memory_order_relaxed);
    if (row.j + 1 == dims.y) planes.add(1);
  });
  return doubtful;
}

}  // namespace

size_t averageRays(const RaySweep& sweep, Progress& progress, double end, Buffer<float>& winding) {
  return fillRows<false>(sweep, progress, end, winding);
}

size_t takeOneRay(const RaySweep& sweep, Progress& progress, double end, Buffer<float>& winding) {
  return fillRows<true>(sweep, progress, end, winding);
}

}  // namespace raymap::cpu
