#pragma once

#include "base/progress.h"
#include "method/cell_mesh.h"

#include <array>

namespace raymap::cpu {

/// Where triangles cross one lattice line, between sample `index` and the next: index -1 stands for all that
/// lies before the first sample, the last sample's index for all that lies beyond it, so that rays also see
/// what the grid does not cover.
struct Crossing {
  int32_t index = 0;
  int32_t signedCount = 0;    ///< w_l (§3.5): +1 for each face that the positive direction leaves through.
  int32_t unsignedCount = 0;  ///< Faces, whichever way they point.
};

/// The axes across a lattice line: u is the lower one.
struct LineAxes {
  int u, v;
  explicit constexpr LineAxes(int axis) : u(axis == 0 ? 1 : 0), v(axis == 2 ? 1 : 2) {}
};

/// All crossings of the lattice lines along one axis: line (u, v), see `LineAxes`, has
/// `entries[starts[v * dims[u] + u] ..]` with ascending, distinct indices.
struct AxisCrossings {
  Buffer<uint64_t> starts;
  Buffer<Crossing> entries;
};

using Crossings = std::array<AxisCrossings, 3>;

/// §3.5. Every line through a shared edge or vertex is counted exactly once and on one side of each sample:
/// all samples are taken as displaced by the same (e, e^2, e^3), e > 0 infinitesimal, and every decision is
/// exact integer arithmetic on vertices snapped to 2^-20 cells. So the six rays of a closed mesh agree at
/// every sample. Snapping is coarser if a vertex lies more than 2^20 cells from sample (0, 0, 0); beyond 2^40
/// cells: Error(Input).
void countCrossings(const CellMesh& mesh, Progress& progress, Crossings& crossings);

}  // namespace raymap::cpu
