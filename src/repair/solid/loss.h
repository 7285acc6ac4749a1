#pragma once

#include <raymap/repair.h>
#include <raymap/surface.h>

#include <span>

#include "mesh/packed_mesh.h"

namespace raymap {

/// Finds out what the lost points of a mesh are, and which distance between samples keeps them. `share` is
/// the share of the mesh's points that `lost` stands for. `options` are those of the field on `grid`.
Loss inspectLoss(const PackedMesh& mesh, const Grid& grid, std::span<const FacePoint> lost, double share,
                 const Options& options, const RepairOptions& repair);

/// Returns a warning that says what was lost, where, how thin it is and what keeps it. Empty if the loss is
/// too small to mention.
std::string describeLoss(const Loss& loss);
/// The same for what bounds no solid.
std::string describeOpenLoss(const Loss& loss);

}  // namespace raymap
