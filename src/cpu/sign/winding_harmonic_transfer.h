#pragma once

#include "base/progress.h"
#include "cpu/sign/winding_harmonic_jumps.h"

#include <array>

namespace raymap::cpu {

/// Right-hand side b of a lattice's equations 6 w - (sum of the six neighbours) = b. It is the jumps that the
/// crossings ask for or, for a correction, the residual of the next finer lattice.
struct RightHandSide {
  const std::array<JumpRows, 3>* jumps = nullptr;
  const float* values = nullptr;

  /// Returns row (j, k). `scratch` must be zero and as long as a row. Call `clear` when the row is done.
  const float* row(const LatticeBox& box, int j, int k, std::vector<float>& scratch) const;
  /// Sets `scratch` to zero again.
  void clear(const LatticeBox& box, int j, int k, std::vector<float>& scratch) const;
};

// All but `overrelaxField` count the samples of the (finer) lattice on `meter`, each once.

/// Runs one red-black relaxation of all samples except the box's outermost ones, which keep their values.
void relaxField(const LatticeBox& box, const RightHandSide& rightHandSide, WorkMeter& meter, float* values);

/// Runs successive over-relaxation (Young 1954), red and black in turn, on one thread. It is for a lattice so
/// small that sharing the work would cost more than the work.
void overrelaxField(const LatticeBox& box, const RightHandSide& rightHandSide, int sweeps, float* values);

/// Carries a field to the next finer lattice. A new sample between two old ones is the mean of the values
/// that both ask for over the lattice edges between. So the field keeps its jumps at the crossings.
void prolongField(const LatticeBox& coarse, const float* from, const LatticeBox& fine,
                  const std::array<JumpRows, 3>& jumps, WorkMeter& meter, float* to);

/// Adds a smooth correction from the next coarser lattice, interpolated linearly.
void addCorrection(const LatticeBox& coarse, const float* from, const LatticeBox& fine, WorkMeter& meter,
                   float* to);

/// Restricts the residual of `values` to the next coarser lattice with full weighting, in the units of that
/// lattice's equations.
void restrictResidual(const LatticeBox& fine, const RightHandSide& rightHandSide, const float* values,
                      const LatticeBox& coarse, WorkMeter& meter, float* residual);

}  // namespace raymap::cpu
