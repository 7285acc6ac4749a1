#pragma once

#include "cpu/distance/surface_tree.h"

namespace raymap::cpu {

/// Computes the distance of each point to the closest of the tree's triangles, in cell units. It is fastest
/// if successive points are close to each other.
void computePointDistances(const SurfaceTree& tree, std::span<const glm::vec3> points,
                           std::span<float> distances);

}  // namespace raymap::cpu
