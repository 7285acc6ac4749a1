// Krayer & Müller 2019, §3.5: from the ray map to the winding number.

#include "cpu/sign/winding.h"

#include <algorithm>

#include "cpu/sign/winding_harmonic.h"
#include "cpu/sign/winding_paths.h"
#include "cpu/sign/winding_rays.h"
#include "cpu/sign/winding_rims_samples.h"
#include "method/winding_paths_offsets.h"

namespace raymap::cpu {

namespace {

/// Returns the share of the rays in the time of a mode.
double shareOfRays(SignMode mode, const FieldOptions& options) {
  if (mode == SignMode::Rays || mode == SignMode::Ray) return 1.0;
  if (usesRims(mode)) return 0.2;
  return 1.0 / (2.0 + double(options.passes) * pointsPerPass(options));
}

}  // namespace

struct Winding::Impl {
  PathScratch paths;
  HarmonicScratch harmonic;

  /// Returns the bytes that a mode has yet to allocate if rays disagree.
  size_t bytesToAllocate(const RaySweep& sweep, SignMode mode, bool isFromRims) const {
    const bool isHarmonic = mode == SignMode::Harmonic;
    if (!isHarmonic && mode != SignMode::Paths && mode != SignMode::Evolution) return 0;
    const size_t held = isHarmonic ? harmonic.bytes() : paths.bytes();
    const size_t needed = isFromRims   ? bytesForRims(sweep.map())
                          : isHarmonic ? HarmonicScratch::bytesNeeded(sweep.map())
                                       : PathScratch::bytesNeeded(sweep.sampleCount());
    return needed - std::min(needed, held);
  }
};

Winding::Winding() : impl_(std::make_unique<Impl>()) {}
Winding::~Winding() = default;

size_t Winding::bytes() const {
  return impl_->paths.bytes() + impl_->harmonic.bytes();
}

double Winding::compute(const RayMap& map, SignMode mode, const FieldOptions& options, const Source& source,
                        Progress& progress, Buffer<float>& winding) {
  const double rays = shareOfRays(mode, options);
  const RaySweep sweep(map);
  const size_t doubtful = mode == SignMode::Ray ? takeOneRay(sweep, progress, rays, winding)
                                                : averageRays(sweep, progress, rays, winding);
  // If the six rays agree everywhere, they are the result of every mode: all paths meet the same counts.
  if (doubtful > 0) {
    const RimLattices* rims = usesRims(mode) ? &source.rims(mode) : nullptr;
    const bool isFromRims = rims && rims->haveAll();
    source.ask(impl_->bytesToAllocate(sweep, mode, isFromRims));
    if (mode == SignMode::Paths)
      averagePaths(sweep, options, progress, rays, impl_->paths, winding);
    else if (mode == SignMode::Evolution)
      evolvePaths(sweep, options, progress, rays, impl_->paths, winding);
    else if (isFromRims)
      computeFromRims(map, *rims, progress, rays, impl_->harmonic, winding);
    else if (mode == SignMode::Harmonic)
      solveHarmonic(map, progress, rays, impl_->harmonic, winding);
  }
  return double(doubtful) / double(sweep.sampleCount());
}

}  // namespace raymap::cpu
