// Krayer & Müller 2019, §3.5, end: the winding number's threshold.

#include "cpu/sign/sign.h"

#include "cpu/sign/ray_sweep.h"

#include <algorithm>
#include <cmath>

namespace raymap::cpu {

namespace {

void rateRow(const RayRow& row, size_t count, float threshold, const float* winding, float* confidence) {
  for (size_t i = 0; i < count; ++i) {
    const bool inside = std::abs(winding[i]) > threshold;
    const auto agrees = [&](int32_t ray) { return (std::abs(float(ray)) > threshold) == inside ? 1 : 0; };
    const int votes = agrees(row.x[i]) + agrees(row.x[i] - row.totalX) + agrees(row.y[i]) +
                      agrees(row.y[i] - row.totalY[i]) + agrees(row.z[i]) + agrees(row.z[i] - row.totalZ[i]);
    confidence[i] = marginOf(winding[i], threshold) * (6.0f + float(votes)) / 12.0f;
  }
}

}  // namespace

float marginOf(float winding, float threshold) {
  const float w = std::abs(winding), below = 1.0f / threshold;
  const float above = threshold < 1.0f ? 1.0f / (1.0f - threshold) : below;
  return std::min(w > threshold ? (w - threshold) * above : (threshold - w) * below, 1.0f);
}

void applySign(const Buffer<float>& winding, double threshold, bool invert, Buffer<float>& distance) {
  const auto limit = static_cast<float>(threshold);
  parallelFor(distance.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const bool inside = std::abs(winding[i]) > limit;
      distance[i] = inside != invert ? -distance[i] : distance[i];
    }
  });
}

void computeConfidence(const RayMap& map, const Buffer<float>& winding, double threshold,
                       Buffer<float>& confidence) {
  confidence.resizeUninitialized(winding.size());
  const RaySweep sweep(map);
  sweep.run([&](const RayRow& row) {
    rateRow(row, sweep.rowLength(), static_cast<float>(threshold), winding.data() + row.first,
            confidence.data() + row.first);
  });
}

}  // namespace raymap::cpu
