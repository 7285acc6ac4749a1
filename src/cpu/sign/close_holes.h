#pragma once

#include <vector>

#include "base/progress.h"
#include "cpu/sign/ray_map.h"
#include "method/close_holes_patch.h"

namespace raymap::cpu {

/// Returns all lattice edges at which surface is missing, sorted by sample, then by axis.
std::vector<MissingEdge> findMissingEdges(const RayMap& map, const Buffer<float>& winding, double threshold,
                                          Progress& progress);

}  // namespace raymap::cpu
