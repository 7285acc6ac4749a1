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

/// Computes every winding number exactly that is so close to the threshold that it may lie on the wrong side.
/// `distance` is the unsigned distance in cells.
void settleByRims(const RayMap& map, const RimLattices& lattices, const Buffer<float>& distance,
                  double threshold, Progress& progress, Buffer<float>& winding);

}  // namespace raymap::cpu
