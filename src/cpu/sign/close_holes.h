#pragma once

#include <vector>

#include "base/progress.h"
#include "cpu/sign/ray_map.h"
#include "method/close_holes_patch.h"

namespace raymap::cpu {

/// All lattice edges at which surface is missing, in the order of their samples and axes.
std::vector<MissingEdge> findMissingEdges(const RayMap& map, const Buffer<float>& winding, double threshold,
                                          Progress& progress);

}  // namespace raymap::cpu
