#pragma once

#include "cpu/sign/crossings.h"
#include "cpu/sign/winding.h"
#include "method/orientation_sides.h"

namespace raymap::cpu {

/// Returns the misfit between the harmonic field and the crossings. It is the sum over all lattice edges of
/// the squared differences between w(i) - w(i + 1) and w_l (Eq. 5), divided by the sum of |w_l|. Returns 0 if
/// nothing is crossed. Any other field than the best fit gives a wrong result.
double measureMisfit(const glm::ivec3& dims, const Crossings& crossings, const Buffer<float>& winding);

/// Returns whether any sample's sign contradicts the parity of all six of its rays. Only samples are used
/// whose winding number is farther from the threshold than the lattice's error.
bool contradictsParity(const RayMap& map, const Buffer<float>& winding, double threshold);

/// Measures the field a step in front of every face and a step behind it, in the mean over the face. The step
/// is one cell, or `farSides` times the square root of twice the face's area if that is longer. Writes the
/// rises to the front, and the wholeness (`NearSides`) if it is asked for. Both are 0 for faces that `turns`
/// leaves out. Empty turns take all faces.
void measureSides(const CellMesh& mesh, const Turns& turns, const Buffer<float>& field, float farSides,
                  Progress& progress, Buffer<float>& rises, Buffer<float>* wholeness = nullptr);

/// Computes the share of each sample's six rays that cross an odd number of faces.
void averageParity(const RayMap& map, Buffer<float>& parity);

}  // namespace raymap::cpu
