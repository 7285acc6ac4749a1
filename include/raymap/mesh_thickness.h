#pragma once

#include <raymap/surface.h>
#include <raymap/verdict.h>

#include <optional>
#include <span>
#include <vector>

namespace raymap {

/// Thickness of a whole mesh. Lengths are in the mesh's units and NaN where there is nothing to measure.
struct ThicknessSummary {
  double thinnest;           ///< Thickness of the thinnest wall.
  glm::dvec3 thinnestAt;     ///< Point of its surface.
  double sharpest;           ///< Least thickness measured beside an edge or a tip that walls run out to.
  glm::dvec3 sharpestAt;     ///< Where.
  double low;                ///< First percentile of the thickness over the area of walls and edges.
  double median;             ///< Median thickness over that area.
  double sheetShare = 0.0;   ///< Share of the mesh's area that is sheets.
  double buriedShare = 0.0;  ///< Share of it that is buried.
  size_t points = 0;         ///< Number of points measured.
};

/// Returns the middles of parts of the faces of a mesh, in the order of the faces. A face is halved until no
/// side of a part is longer than `step`, but at most 22 times. Throws `Error(Memory)` if the points do not
/// fit.
RAYMAP_API std::vector<FacePoint> sampleFaces(const MeshView& mesh, double step);

/// Returns the summary of what was measured at points.
RAYMAP_API ThicknessSummary summarizeThickness(std::span<const FacePoint> points,
                                               std::span<const Thickness> thickness);

/// Measures the thickness at 100,000 points that are spread evenly over the area of the mesh.
/// `machine.threads` and `progress` are used.
RAYMAP_API ThicknessSummary summarizeThickness(const Surface& surface, const ThicknessOptions& options = {},
                                               const MachineOptions& machine = {});

/// Judges a mesh as `judge` without it does, and by the thickness of the thinnest part: of solids of at most
/// two million triangles, as far as it is thinner than a 25th of the longest side. Uses `machine` and throws
/// as `findThinnest` does.
RAYMAP_API Verdict judge(const MeshView& mesh, const Diagnostics& found, const SelfIntersections& crossings,
                         const MachineOptions& machine = {});

/// Returns the thickness of a mesh's thinnest part: the local thickness that all but 0.2 % of the area
/// exceeds, at 5,000 points. So tips, and specks that noise makes, are ignored. Returns nothing if no such
/// part is thinner than `maxThickness`. Uses `machine` and throws `Error` as `Surface` does. Takes less than
/// 0.1 s for a hundred thousand triangles, but as long as `diagnose` for a million.
RAYMAP_API std::optional<double> findThinnest(const MeshView& mesh, double maxThickness,
                                              const MachineOptions& machine = {});

}  // namespace raymap
