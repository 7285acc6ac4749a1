#pragma once

#include <raymap/local_thickness.h>
#include <raymap/repair.h>

#include <vector>

#include "base/progress.h"
#include "mesh/packed_mesh.h"
#include "repair/solid/deviation.h"
#include "repair/solid/hollow.h"

namespace raymap {

/// Default of `RepairOptions::tolerance`, in samples.
inline constexpr double kDefaultTolerance = 0.1;

/// Points of a mesh, moved by the offset, that the result should show.
struct ExpectedPoints {
  SurfacePoints points;
  std::vector<double> areas;   ///< For each face of the mesh, the area that one of its points stands for.
  std::vector<bool> isInside;  ///< For each point, whether the field has it inside the solid.
};

/// Finds what is wrong with a mesh.
void inspect(const PackedMesh& mesh, Diagnostics& found, SelfIntersections& crossing,
             Arrangement& arrangement);

/// Returns points of a mesh on the surface moved by the offset, and reports the share of points that have no
/// place there. `solid` is the field after the offset, before anything is hollowed out.
ExpectedPoints expectedPoints(const PackedMesh& mesh, const Field& solid, const RepairOptions& repair,
                              RepairReport& report);

/// Fills in the report's figures of the result, and how far the meshes deviate from each other. `expected`
/// comes from `expectedPoints`. Returns the lost points, or some of them if they are many, where they are on
/// the mesh.
std::vector<FacePoint> measure(const PackedMesh& mesh, const PackedMesh& result, const Grid& grid,
                               const RepairOptions& repair, const std::vector<DrainHole>& holes,
                               ExpectedPoints expected, Progress& progress, RepairReport& report);

}  // namespace raymap
