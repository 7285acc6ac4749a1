#pragma once

#include <raymap/local_thickness.h>

#include <span>
#include <string>

#include "base/progress.h"
#include "repair/solid/given.h"

namespace raymap {

/// Finds out what the lost points of a mesh are, and which distance between samples keeps them. `share` is
/// the share of the mesh's points that `lost` stands for.
Loss inspectLoss(Given& given, std::span<const FacePoint> lost, double share, Progress& progress);

/// Returns a warning that says what was lost, where, how thin it is and what keeps it. Empty if the loss is
/// too small to mention.
std::string describeLoss(const Loss& loss);
/// The same for what bounds no solid.
std::string describeOpenLoss(const Loss& loss);

}  // namespace raymap
