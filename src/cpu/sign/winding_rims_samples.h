#pragma once

#include "base/progress.h"
#include "cpu/sign/winding_harmonic.h"
#include "method/winding_rims_lattices.h"

namespace raymap::cpu {

/// Fills `winding` with winding numbers that follow from rays and rims: exactly where `lattices` says so,
/// elsewhere by interpolation that keeps to all crossings. Reports the part of the stage from `begin` on.
void computeFromRims(const RayMap& map, const RimLattices& lattices, Progress& progress, double begin,
                     HarmonicScratch& scratch, Buffer<float>& winding);

/// Returns about how many bytes the scratch memory holds after `computeFromRims` on this map.
size_t bytesForRims(const RayMap& map);

/// Computes the winding numbers of these samples exactly.
void settleByRims(const RayMap& map, const RimLattices& lattices, std::span<const uint32_t> samples,
                  Progress& progress, Buffer<float>& winding);

}  // namespace raymap::cpu
