#pragma once

#include "base/progress.h"
#include "method/cell_mesh.h"
#include "predicates/lattice_line_triangle.h"

#include <array>
#include <vector>

namespace raymap::cpu {

/// Crossings of triangles with one lattice line, between sample `index` and the next. Index -1 stands for all
/// crossings before the first sample, the last sample's index for all beyond it. So rays also see the parts
/// of the mesh outside the grid.
struct Crossing {
  int32_t index = 0;
  int32_t signedCount = 0;    ///< w_l (§3.5): +1 for each face that the positive direction leaves through.
  int32_t unsignedCount = 0;  ///< Number of faces, whichever way they point.
};

/// All crossings of the lattice lines along one axis. Line (u, v), see `LineAxes`, has
/// `entries[starts[v * dims[u] + u] ..]` with ascending, distinct indices.
struct AxisCrossings {
  Buffer<uint64_t> starts;
  Buffer<Crossing> entries;
};

using Crossings = std::array<AxisCrossings, 3>;

/// Returns the bytes of the crossings, and of what sorts them, of a mesh of which most lines meet
/// `kExpectedCrossings`.
size_t crossingBytesExpected(const glm::ivec3& dims);
inline constexpr size_t kExpectedCrossings = 2;

/// Lattice lines of a part of a loop.
inline constexpr size_t kLinesPerTask = 4096;

/// Counts the crossings of all lattice edges (§3.5). Every line through a shared edge or vertex is counted
/// exactly once and on one side of each sample. To this end all samples are displaced by the same (e, e^2,
/// e^3), e > 0 infinitesimal. Every decision is exact integer arithmetic on vertices snapped to 2^-20 cells.
/// So the six rays of a closed mesh agree at every sample. Snapping is coarser if a vertex lies more than
/// 2^20 cells from sample (0, 0, 0). Throws `Error(Input)` if a vertex lies beyond 2^40 cells.
void countCrossings(const CellMesh& mesh, Progress& progress, Crossings& crossings);

/// Sets the crossings to those of a mesh without faces.
void clearCrossings(const glm::ivec3& dims, Crossings& crossings);

/// Faces that a change removes, adds, and reverses. These are as they are after it.
struct ChangedFaces {
  std::vector<glm::uvec3> removed, added, reversed;
};

/// Changes the crossings to those of a mesh with other faces. `mesh` has the faces after the change, which
/// must use the same vertices as those before it.
void changeCrossings(const CellMesh& mesh, const ChangedFaces& changed, Progress& progress,
                     Crossings& crossings);

}  // namespace raymap::cpu
