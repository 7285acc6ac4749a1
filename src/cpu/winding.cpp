// Krayer & Müller 2019, §3.5: from the ray map to the winding number.

#include "winding.h"

#include "winding_harmonic.h"
#include "winding_paths.h"
#include "winding_rays.h"

namespace raymap {

struct Winding::Impl {
  PathScratch paths;
  HarmonicScratch harmonic;
};

Winding::Winding() : impl_(std::make_unique<Impl>()) {}
Winding::~Winding() = default;

size_t Winding::bytes() const {
  return impl_->paths.bytes() + impl_->harmonic.bytes();
}

WindingSummary Winding::compute(const RayMap& map, const Options& options, Progress& progress,
                                Buffer<float>& winding) {
  const RaySweep sweep(map);
  const size_t doubtful = averageRays(sweep, winding);
  // Where the six rays agree everywhere they are the answer of every mode: all paths meet the same counts.
  if (doubtful > 0) {
    if (options.sign == SignMode::Paths)
      averagePaths(sweep, options, progress, impl_->paths, winding);
    else if (options.sign == SignMode::Evolution)
      evolvePaths(sweep, options, progress, impl_->paths, winding);
    else if (options.sign == SignMode::Harmonic)
      solveHarmonic(map, progress, impl_->harmonic, winding);
  }
  return {double(doubtful) / double(sweep.sampleCount())};
}

}  // namespace raymap
