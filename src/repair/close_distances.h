#pragma once

#include "cpu/points/point_query.h"

namespace raymap {

/// Measures distances of points to a mesh, exactly up to a largest one.
class CloseDistances {
 public:
  CloseDistances(const PackedMesh& mesh, double most) : options_{.triangle = true, .maxDistance = most} {
    surface_.mesh = mesh;
    surface_.grid = fitGrid(mesh);
    CellMesh cells;
    toCellUnits(mesh, surface_.grid, cells);
    surface_.tree.build(cells);
  }

  /// Returns distances and closest triangles.
  QueryResult measure(const PointsView& points) const {
    Progress silent;
    QueryResult result;
    cpu::queryPoints(surface_, points, options_, silent, result);
    return result;
  }

 private:
  cpu::PreparedSurface surface_;
  QueryOptions options_;
};

}  // namespace raymap
