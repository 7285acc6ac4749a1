#pragma once

#include <raymap/diagnostics.h>
#include <raymap/generate.h>

#include <cstddef>

namespace raymap {

/// What to make of a mesh besides a closed one. Lengths are in the mesh's units.
struct RepairOptions {
  double offset = 0.0;  ///< Move the surface outwards by this; inwards if negative.
  double shell = 0.0;   ///< Hollow it out, leaving walls this thick; 0 = solid.
  double drainHole =
      0.0;  ///< Diameter of a hole from the lowest point of each hollow straight down; 0 = none.
  glm::dvec3 down{0.0, 0.0, -1.0};
};

/// How far points of one surface lie from where they should, in the mesh's units.
struct Deviation {
  double max = 0.0;
  double mean = 0.0;
  double p99 = 0.0;   ///< 99 % of the points deviate less.
  size_t points = 0;  ///< How many were measured.
};

/// What a repair did.
struct RepairReport {
  Stats stats;                                      ///< Of making the field.
  Diagnostics before;                               ///< Of the mesh,
  Diagnostics after;                                ///< and of the result,
  SelfIntersections crossingBefore, crossingAfter;  ///< and their faces that cross.
  Deviation ofResult;  ///< Of points of the result from the mesh's surface, moved by the offset.
  Deviation ofMesh;    ///< Of points of the mesh, those below left out, from the result, moved by the offset.
  double buriedShare =
      0.0;  ///< Share of the mesh's points inside the solid, a sample and more from its surface.
  double lostShare = 0.0;  ///< Share of them outside, as far: thinner than the samples or open there.
  size_t hollows = 0;      ///< Hollows that the shell left,
  size_t holes = 0;        ///< and drain holes.
};

/// A watertight solid in place of any mesh: the isosurface of its field on `grid`, which must hold the
/// result. `report` may be null. Throws `Error` as `generate` and `isosurface` do, and Usage if walls or
/// holes are thinner than two samples.
Mesh repair(const Mesh& mesh, const Grid& grid, const Options& options, const RepairOptions& repair,
            RepairReport* report = nullptr);

}  // namespace raymap
