// Krayer & Müller 2019, §3.5: from the ray map to the winding number.

#include "cpu/sign/winding.h"

#include "cpu/sign/winding_harmonic.h"
#include "cpu/sign/winding_paths.h"
#include "cpu/sign/winding_rays.h"

namespace raymap::cpu {

struct Winding::Impl {
  PathScratch paths;
  HarmonicScratch harmonic;
};

Winding::Winding() : impl_(std::make_unique<Impl>()) {}
Winding::~Winding() = default;

size_t Winding::bytes() const {
  return impl_->paths.bytes() + impl_->harmonic.bytes();
}

double Winding::compute(const RayMap& map, SignMode mode, const Options& options, Progress& progress,
                        Buffer<float>& winding) {
  const RaySweep sweep(map);
  const size_t doubtful = averageRays(sweep, winding);
  // If the six rays agree everywhere, they are the result of every mode: all paths meet the same counts.
  if (doubtful > 0) {
    if (mode == SignMode::Paths)
      averagePaths(sweep, options, progress, impl_->paths, winding);
    else if (mode == SignMode::Evolution)
      evolvePaths(sweep, options, progress, impl_->paths, winding);
    else if (mode == SignMode::Harmonic)
      solveHarmonic(map, progress, impl_->harmonic, winding);
  }
  return double(doubtful) / double(sweep.sampleCount());
}

}  // namespace raymap::cpu
