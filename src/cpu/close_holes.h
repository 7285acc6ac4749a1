#pragma once

#include <vector>

#include "hole_patch.h"
#include "progress.h"
#include "ray_map.h"

namespace raymap {

/// All lattice edges at which surface is missing, in the order of their samples and axes.
std::vector<MissingEdge> findMissingEdges(const RayMap& map, const Buffer<float>& winding, double threshold,
                                          Progress& progress);

}  // namespace raymap
