#pragma once

#include <raymap/repair.h>

#include <vector>

#include "base/progress.h"
#include "mesh/packed_mesh.h"
#include "repair/hollow.h"

namespace raymap {

/// Returns points of the mesh that the result should show, in samples, and reports the shares of the buried
/// and the lost ones. `solid` is the field after the offset, before anything is hollowed out.
std::vector<glm::vec3> visiblePoints(const PackedMesh& mesh, const Field& solid, const RepairOptions& repair,
                                     RepairReport& report);

/// Fills in the report's figures of both meshes, and how far they deviate from each other. `visible` comes
/// from `visiblePoints`.
void measure(const PackedMesh& mesh, const PackedMesh& result, const Grid& grid, const RepairOptions& repair,
             const std::vector<DrainHole>& holes, std::vector<glm::vec3> visible, Progress& progress,
             RepairReport& report);

}  // namespace raymap
