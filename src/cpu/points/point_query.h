#pragma once

#include <raymap/surface.h>

#include <optional>

#include "base/progress.h"
#include "cpu/points/point_winding.h"

namespace raymap::cpu {

/// A mesh prepared for queries, which change nothing in it.
struct PreparedSurface {
  PackedMesh mesh;
  Grid grid;         ///< Grid in whose cells the trees are.
  SurfaceTree tree;  ///< Faces as given; only one of each pair of double-sided ones.
  bool isSigned = false;

  // Filled if `isSigned`.
  Turns turns;                            ///< How the sign takes each face; empty: all as given.
  std::optional<SurfaceTree> turnedTree;  ///< Faces as the sign takes them; none: those of `tree`.
  WindingDipoles dipoles;                 ///< Dipoles of the faces as the sign takes them.
  WindingLattice lattice;
  double threshold = 0.5;

  const SurfaceTree& signTree() const { return turnedTree ? *turnedTree : tree; }
  size_t bytes() const;
};

/// Answers a query with all threads of the caller's arena.
void queryPoints(const PreparedSurface& surface, const PointsView& points, const QueryOptions& options,
                 Progress& progress, QueryResult& result);

}  // namespace raymap::cpu
