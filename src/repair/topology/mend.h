#pragma once

#include <raymap/diagnostics.h>
#include <raymap/options.h>
#include <raymap/repair.h>

#include <optional>
#include <vector>

#include "mesh/model.h"
#include "repair/topology/fill_holes.h"

namespace raymap {

/// Returns whether these counts find nothing wrong with a mesh: every edge has two faces that agree, the
/// faces point outwards, and none is degenerate or a duplicate.
bool looksRight(const Diagnostics& found, bool mayBeDegenerate = false);

/// Returns whether no faces cross, and the search for them is complete.
bool crossesNowhere(const SelfIntersections& crossing);

/// Turns the faces that contradict most faces of their part, and returns them, ascending. Leaves the mesh as
/// it is if faces contradict each other then, or with `mayLeaveSome`, if that is at no fewer edges.
std::vector<uint32_t> turnBack(Mesh& mesh, bool mayLeaveSome = false);

/// Returns whether nothing at all is wrong with a mesh. `crossing` receives the faces that cross.
bool isAllRight(const Model& mesh, SelfIntersections* crossing = nullptr, bool mayBeDegenerate = false);

/// A mesh with what is certain mended: faces turned back, holes closed.
struct Mended {
  Mesh mesh = {};                     ///< The faces as given and in their order, then those that were added.
  std::vector<uint32_t> turned = {};  ///< Faces that were turned, ascending.
  FilledHoles filled = {};            ///< Holes that were closed. Those of a base, too.
  bool isRight = false;               ///< Whether nothing is wrong with it now, so its faces can be kept.

  bool isChanged() const { return !turned.empty() || filled.faces > 0; }
};

/// Mends a mesh without making its faces anew. `found` and `crossing` are what is wrong with it. Without
/// `mayKeep` nobody wants to know whether the mesh is right afterwards.
///
/// Turns back the faces of a part that contradict most of its faces, and parts with such faces that are
/// outermost and inside out then. Joins open edges to a base if one is asked
/// for. Closes all holes if that makes the mesh right; else those that a plane closes (`fillFlatHoles`).
/// Undoes turns that leave the mesh open or its faces at odds. Throws `Error(Input)` where there is no base.
Mended mend(const Model& mesh, const Diagnostics& found, const SelfIntersections& crossing,
            Orientation orientation, const RepairOptions& repair, bool mayKeep);

}  // namespace raymap
