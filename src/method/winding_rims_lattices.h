#pragma once

#include <raymap/grid.h>
#include <raymap/options.h>

#include <span>
#include <vector>

#include "mesh/packed_mesh.h"
#include "mesh/rim_edges.h"
#include "method/winding_dipoles_shared.h"
#include "method/winding_doubts_shared.h"
#include "method/winding_rims_shared.h"

namespace raymap {

/// The rims of a surface over a grid, and the samples whose winding numbers are computed from rays and rims.
/// All others lie between samples of the next coarser lattice, and so far from rims that their numbers may be
/// interpolated.
struct RimLattices {
  std::vector<RimLine> rims;  ///< In cell units; empty if they are too many.
  glm::vec3 centre{0.0f};     ///< Centre of the rims' bounds, in cell units.
  uint32_t looks = 0;         ///< Looks at the dipoles before rims decide near the threshold.
  /// Places in `rimDims`, x fastest, by level; the coarsest has all samples. Empty if it takes less time to
  /// fit the field to all crossings, or if the mesh reaches beyond the grid.
  std::vector<std::vector<uint32_t>> computed;

  size_t bytes() const;
  /// Returns whether all numbers follow from rims.
  bool haveAll() const { return !computed.empty(); }
  /// Returns what numbers come from before dipoles or rims decide: `kFromRims` or `kFromFit`.
  uint32_t source() const { return haveAll() ? kFromRims : kFromFit; }
};

/// Returns whether a mode takes winding numbers from the crossings and the rims of a mesh.
constexpr bool usesRims(SignMode mode) {
  return mode == SignMode::Harmonic || mode == SignMode::Exact;
}

/// Returns the level of the coarsest lattice.
int coarsestRimLevel(const glm::ivec3& dims);

/// Returns the rims of a mesh and the samples to be computed: all of the grid in `SignMode::Exact`. `edges`
/// are what `findRimEdges` finds.
RimLattices findRimLattices(const PackedMesh& mesh, std::span<const RimEdge> edges, const Grid& grid,
                            SignMode mode);
RimLattices findRimLattices(const PackedMesh& mesh, const Grid& grid, SignMode mode = SignMode::Harmonic);

}  // namespace raymap
