#pragma once

#include "cpu/distance/surface_tree.h"

namespace raymap::cpu {

/// Returns whether a triangle of the tree is within `radius` of a point, all in cell units. Much faster than
/// a search for the closest one, which costs most in the middle of a body.
bool isNearSurface(const SurfaceTree& tree, const glm::vec3& p, float radius);

}  // namespace raymap::cpu
