#pragma once

#include <raymap/machine.h>
#include <raymap/query.h>

#include <optional>

#include "base/progress.h"
#include "cpu/distance/surface_tree.h"
#include "cpu/points/point_winding.h"
#include "cpu/sign/winding_dipoles.h"
#include "cpu/sign/winding_rims.h"
#include "mesh/model.h"

namespace raymap::cpu {

/// A mesh prepared for queries, which change nothing in it. Refers to the mesh's arrays.
struct PreparedSurface {
  PackedMesh mesh;
  Box bounds;        ///< Those of the mesh.
  Grid grid;         ///< Grid in whose cells the trees are.
  SurfaceTree tree;  ///< Faces as given; only one of each pair of double-sided ones.
  bool isSigned = false;

  // Filled if `isSigned`.
  Turns turns;                            ///< How the sign takes each face; empty: all as given.
  Buffer<glm::uvec3> turnedTriangles;     ///< Faces as the sign takes them; empty: as given.
  std::optional<SurfaceTree> turnedTree;  ///< Tree of them; none: `tree` serves.
  WindingRims rims;                       ///< Rims of the faces as the sign takes them.
  WindingDipoles dipoles;                 ///< Dipoles of the faces as the sign takes them, of many rims.
  WindingLattice lattice;
  double threshold = 0.5;

  const SurfaceTree& signTree() const { return turnedTree ? *turnedTree : tree; }
  /// Returns what winding numbers are computed from: without rims, if too many to tell signs.
  WindingSource windingSource() const;
  /// Returns the mesh with its faces as the sign takes them.
  PackedMesh turnedMesh() const;
  /// Returns the bytes held, without those of `mesh`.
  size_t bytes() const;
};

/// Prepares a mesh for distances alone. The tree is in cells of the grid, which need not hold the mesh.
PreparedSurface prepareUnsigned(const PackedMesh& mesh, const Grid& grid, Frames frames = Frames::Stored);

/// Prepares a mesh for distances, with a sign if the options ask for one. Fills `stats` but for the total
/// time.
PreparedSurface prepareSurface(const Model& mesh, const SurfaceOptions& options,
                               const MachineOptions& machine, Progress& progress, Stats& stats);

/// Does the same for a mesh whose faces another run has turned and left out, with a sign. `turns` is empty if
/// the sign takes all faces as given.
PreparedSurface prepareTurned(const PackedMesh& mesh, const Turns& turns, double threshold,
                              const MachineOptions& machine, Progress& progress);

}  // namespace raymap::cpu
