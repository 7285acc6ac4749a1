#pragma once

#include <raymap/local_thickness.h>

#include <span>

#include "base/progress.h"
#include "repair/solid/given.h"

namespace raymap {

/// Finds out what the lost points of a mesh are, and which distance between samples keeps them. `share` is
/// the share of the mesh's points that `lost` stands for.
Loss inspectLoss(Given& given, std::span<const FacePoint> lost, double share, Progress& progress);

/// Warns of all that was lost, unless it is too small to mention.
void warnOfLoss(const Loss& loss, const RepairOptions& repair, const WarningCallback& warn);

}  // namespace raymap
