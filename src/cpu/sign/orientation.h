#pragma once

#include "cpu/sign/crossings.h"
#include "cpu/sign/winding.h"
#include "method/orientation_sides.h"

namespace raymap::cpu {

/// How badly a field fits the crossings: the squares of what w(i) - w(i + 1) misses of w_l (Eq. 5), summed
/// over all lattice edges, over the sum of |w_l|. 0 where nothing is crossed.
double measureMisfit(const glm::ivec3& dims, const Crossings& crossings, const Buffer<float>& winding);

/// Whether any sample's sign contradicts the parity of all six of its rays, where the winding number is
/// farther from the threshold than the lattice's error.
bool contradictsParity(const RayMap& map, const Buffer<float>& winding, double threshold);

/// For every face how much a field rises along its normal, from a cell behind it to a cell before it, in the
/// mean over the face. With `farSides` the steps are as long as so many times the root of twice its area.
void measureRises(const CellMesh& mesh, const Buffer<float>& field, float farSides, Progress& progress,
                  Buffer<float>& rises);

/// The share of the six rays of each sample that cross an odd number of faces.
void averageParity(const RayMap& map, Buffer<float>& parity);

}  // namespace raymap::cpu
