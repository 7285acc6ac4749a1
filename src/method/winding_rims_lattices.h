#pragma once

#include <raymap/grid.h>

#include <optional>
#include <vector>

#include "mesh/packed_mesh.h"
#include "mesh/rim_edges.h"
#include "method/winding_rims_shared.h"

namespace raymap {

/// The rims of a surface over a grid, and the samples whose winding numbers are computed from rays and rims. All others lie
/// between samples of the next coarser lattice, and so far from rims that their numbers may be interpolated.
struct RimLattices {
  std::vector<RimLine> rims;                         ///< In cell units.
  std::vector<std::vector<uint32_t>> computed;  ///< By level; the coarsest has all samples. Places in `rimDims`, x fastest.
};

/// Returns the level of the coarsest lattice.
int coarsestRimLevel(const glm::ivec3& dims);

/// Returns the rims of a mesh and the samples to be computed. Returns nothing if it would take longer than to fit the field
/// to all crossings, or if the mesh reaches beyond the grid.
std::optional<RimLattices> findRimLattices(const PackedMesh& mesh, const Grid& grid);

}  // namespace raymap
