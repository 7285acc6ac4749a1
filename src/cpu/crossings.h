#pragma once

#include "cell_mesh.h"

#include <array>

namespace raymap {

/// Where triangles cross one lattice line, between sample `index` and the next: index -1 lies before the
/// first sample, the last sample's index stands for everything beyond it, so that rays also see what the grid
/// does not cover.
struct Crossing {
  int32_t index = 0;
  int32_t signedCount = 0;    ///< w_l (§3.5): +1 for each face that the positive direction leaves through.
  int32_t unsignedCount = 0;  ///< Faces, whichever way they point.
};

/// All crossings of the lattice lines along one axis: line (u, v), u the lower of the two other axes, has
/// `entries[starts[v * dims[u] + u] ..]` with ascending, distinct indices.
struct AxisCrossings {
  Buffer<uint64_t> starts;
  Buffer<Crossing> entries;
};

using Crossings = std::array<AxisCrossings, 3>;

/// §3.5. A line through a shared edge or vertex is counted exactly once: samples are taken as infinitesimally
/// displaced by (e, e^2, e^3), and every decision is exact integer arithmetic on vertices snapped to 2^-20
/// cells.
void countCrossings(const CellMesh& mesh, Crossings& crossings);

}  // namespace raymap
