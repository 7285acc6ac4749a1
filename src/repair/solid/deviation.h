#pragma once

#include <raymap/grid.h>
#include <raymap/repair.h>

#include <algorithm>
#include <span>
#include <vector>

#include "base/progress.h"
#include "mesh/packed_mesh.h"

namespace raymap {

/// Points of a mesh, in samples of a grid.
struct SurfacePoints {
  std::vector<glm::vec3> positions;
  std::vector<uint32_t> faces;  ///< For each point, a triangle that it lies on.

  void add(const glm::vec3& position, size_t face) {
    positions.push_back(position);
    faces.push_back(static_cast<uint32_t>(face));
  }

  /// Removes the points whose number fulfils a condition. It is asked for every point once, in order.
  template <class Condition>
  void eraseIf(Condition&& isErased) {
    size_t kept = 0;
    for (size_t i = 0; i < positions.size(); ++i) {
      if (isErased(i)) continue;
      positions[kept] = positions[i];
      faces[kept++] = faces[i];
    }
    positions.resize(kept);
    faces.resize(kept);
  }
};

/// Points of a mesh, moved by the offset, that the result should show.
struct ExpectedPoints {
  SurfacePoints points;
  std::vector<double> areas;   ///< For each face of the mesh, the area that one of its points stands for.
  std::vector<bool> isInside;  ///< For each point, whether the field has it inside the solid.
};

/// Returns points of a mesh: its vertices, and points in rows on its triangles that are at most `step`
/// samples apart; none on flat triangles. Each point of a triangle stands for about as much area. The points
/// are sparser if there would be too many.
SurfacePoints surfacePoints(const PackedMesh& mesh, const Grid& grid, double step);

/// Returns for each face of a mesh the area that one of its points stands for.
std::vector<double> areasOfPoints(const PackedMesh& mesh, const SurfacePoints& points);

/// Distance between points that are measured, in samples.
inline constexpr double kPointStep = 0.5;

/// Visits many points at a time, in samples of the grid and in the mesh's units.
template <class Visit>
void forEachPart(std::span<const glm::vec3> points, const Grid& grid, Visit&& visit) {
  constexpr size_t kPart = size_t{1} << 18;
  std::vector<glm::dvec3> positions;
  for (size_t begin = 0; begin < points.size(); begin += kPart) {
    const std::span<const glm::vec3> part = points.subspan(begin, std::min(kPart, points.size() - begin));
    positions.clear();
    for (const glm::vec3& p : part) positions.push_back(grid.position(p));
    visit(part, std::span<const glm::dvec3>(positions));
  }
}

/// Returns the exact distances of points to a mesh, all in samples of the grid.
std::vector<float> distancesTo(const PackedMesh& mesh, const Grid& grid, std::span<const glm::vec3> points,
                               Progress& progress);

/// The distance of a point, in samples, and the area that it stands for.
struct AreaDistance {
  float distance = 0.0f;
  double area = 0.0;
};

/// Returns statistics over the area, with distances multiplied by `spacing`. Sorts the distances.
Deviation summarize(std::vector<AreaDistance>& found, double spacing);

}  // namespace raymap
