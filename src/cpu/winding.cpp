// Krayer & Müller 2019, §3.5: from the ray map to the winding number.

#include "winding.h"

#include "winding_rays.h"

namespace raymap {

struct Winding::Impl {};

Winding::Winding() : impl_(std::make_unique<Impl>()) {}
Winding::~Winding() = default;

size_t Winding::bytes() const {
  return 0;
}

WindingSummary Winding::compute(const RayMap& map, const Options& options, Progress& progress,
                                Buffer<float>& winding) {
  const RaySweep sweep(map);
  const size_t doubtful = averageRays(sweep, winding);
  (void)options;
  (void)progress;
  return {double(doubtful) / double(sweep.sampleCount())};
}

}  // namespace raymap
