#pragma once

#include <raymap/surface.h>

#include <optional>

#include "base/progress.h"
#include "cpu/points/point_winding.h"

namespace raymap::cpu {

/// What queries need of a mesh. Nothing in it changes between them.
struct PreparedSurface {
  PackedMesh mesh;
  Grid grid;         ///< The trees are in its cells.
  SurfaceTree tree;  ///< The faces as given. Of double-sided faces, only one.
  bool isSigned = false;

  // Filled if `isSigned`.
  Turns turns;                            ///< How the sign takes the faces; empty: all as given.
  std::optional<SurfaceTree> turnedTree;  ///< The faces as the sign takes them; none: `tree`.
  WindingDipoles dipoles;                 ///< Of the faces as the sign takes them.
  WindingLattice lattice;
  double threshold = 0.5;

  const SurfaceTree& signTree() const { return turnedTree ? *turnedTree : tree; }
  size_t bytes() const;
};

/// Answers a query with all threads of the caller's arena.
void queryPoints(const PreparedSurface& surface, const PointsView& points, const QueryOptions& options,
                 Progress& progress, QueryResult& result);

}  // namespace raymap::cpu
