#pragma once

#include "base/progress.h"
#include "cpu/sign/winding_harmonic_jumps.h"

#include <array>

namespace raymap::cpu {

/// The right-hand side of a lattice's equations 6 w - (sum of the six neighbours) = b: either the jumps that
/// the crossings ask for, or, for a correction, the residual of the next finer lattice.
struct RightHandSide {
  const std::array<JumpRows, 3>* jumps = nullptr;
  const float* values = nullptr;

  /// Row (j, k); `scratch` must be zero, as long as a row, and given back by `clear`.
  const float* row(const LatticeBox& box, int j, int k, std::vector<float>& scratch) const;
  void clear(const LatticeBox& box, int j, int k, std::vector<float>& scratch) const;
};

/// One red-black relaxation of all samples but the box's outermost ones, which keep their values.
void relaxField(const LatticeBox& box, const RightHandSide& rightHandSide, Progress& progress, float* values);

/// Successive over-relaxation (Young 1954), red and black in turn: for a lattice so small that sharing the
/// work would cost more than the work.
void overrelaxField(const LatticeBox& box, const RightHandSide& rightHandSide, int sweeps, float* values);

/// Carries a field to the next finer lattice: a new sample between two old ones is the mean of what both ask
/// of it over the lattice edges between, so that the field keeps its jumps where the crossings are.
void prolongField(const LatticeBox& coarse, const float* from, const LatticeBox& fine,
                  const std::array<JumpRows, 3>& jumps, float* to);

/// Adds a smooth correction from the next coarser lattice, linear between its samples.
void addCorrection(const LatticeBox& coarse, const float* from, const LatticeBox& fine, float* to);

/// Gathers what `values` still miss of their right-hand side on the next coarser lattice: full weighting, in
/// the units of that lattice's equations.
void restrictResidual(const LatticeBox& fine, const RightHandSide& rightHandSide, const float* values,
                      const LatticeBox& coarse, float* residual);

}  // namespace raymap::cpu
