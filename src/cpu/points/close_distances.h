#pragma once

#include "cpu/points/point_query.h"

namespace raymap::cpu {

/// Measures distances of points to a mesh, exactly up to a largest one.
class CloseDistances {
 public:
  /// The search works in cells of `grid`, which need not hold the mesh.
  CloseDistances(const PackedMesh& mesh, const Grid& grid, double most)
      : surface_(prepareUnsigned(mesh, grid)), options_{.triangle = true, .maxDistance = most} {}
  CloseDistances(const PackedMesh& mesh, double most) : CloseDistances(mesh, fitGrid(mesh), most) {}

  /// Returns distances and closest triangles.
  QueryResult measure(const PointsView& points) const {
    Progress silent;
    QueryResult result;
    queryPoints(surface_, points, options_, silent, result);
    return result;
  }

 private:
  PreparedSurface surface_;
  QueryOptions options_;
};

}  // namespace raymap::cpu
