#pragma once

// The stages of a repair, in the order of repair/pipeline.h.

#include "repair/run.h"

namespace raymap {

/// Finds what is wrong with the given mesh, and mends what is certain. Keeps its faces if nothing is wrong
/// then.
void inspectGiven(RepairRun& run);

/// Unites the parts of the mesh that cross, overlap or touch, each group that is apart from the others by
/// itself. `RepairRun::kept` is then what is right; the rest must become a field. Returns whether there is
/// no rest.
bool uniteGroups(RepairRun& run);
/// Adds the faces that were kept to the result.
void joinKept(RepairRun& run);

/// Returns the thickness of the plates: that of the options, or the least that no samples miss.
double leastThickness(const RepairOptions& repair, const Grid& grid);
/// Unites the solid with plates of `RepairReport::leastThickness` in place of what is thinner in the mesh, or
/// missed by the samples: around the middle between the two sides of walls, and around sheets. Warns of walls
/// that became more than twice as thick.
void thickenThinParts(RepairRun& run);

/// Throws `Error(Input)` if no sample of a solid is inside.
void requireInside(const Field& solid);
/// Drops crumbs and bubbles from the solid and its surface, `RepairRun::result`.
void dropPieces(RepairRun& run);

/// Chooses points of the mesh on the surface moved by the offset, before anything is hollowed out, and
/// reports the share of points that have no place there.
void placeExpectedPoints(RepairRun& run);
/// Makes the solid hollow, drills its drain holes, and takes the surface of that. Hollows that a drain hole
/// does not fit into stay solid: nothing could leave them. Warns of what was asked for but not made.
void makeHollow(RepairRun& run);

/// Default of `RepairOptions::tolerance`, in samples.
inline constexpr double kDefaultTolerance = 0.1;
/// Simplifies the result, at points `step` apart, within `tolerance` if nothing else is asked for.
void simplifyResult(RepairRun& run, double step, double tolerance);
/// Warns if the result reaches far beyond the mesh, then rounds it as its file does.
void roundResult(RepairRun& run);
/// Counts the pieces of the result, and finds what is wrong with it.
void inspectResult(RepairRun& run);

/// Cuts the result at `RepairOptions::cutPlane`, rounds it again, and finds what is wrong with it.
void cutResult(RepairRun& run);

/// Measures how far the mesh and the result deviate from each other. `RepairRun::lost` is then the lost
/// points, or some of them if they are many, where they are on the mesh.
void measure(RepairRun& run);
/// Leaves out the lost points of parts that were dropped: no samples would keep them.
void leaveOutDropped(RepairRun& run);
/// Finds out what the lost points of a mesh are, and which distance between samples keeps them. Warns of all
/// that is lost, with the dropped parts.
void inspectLoss(RepairRun& run);

/// Warns of all that was lost, unless it is too small to mention.
void warnOfLoss(const Loss& loss, const RepairOptions& repair, const WarningCallback& warn);
/// Finds what is wrong with a mesh.
void inspect(const Model& mesh, Diagnostics& found, SelfIntersections& crossing, Arrangement& arrangement);
/// Throws `Error(Input)` if no part of a surface is left.
void requireParts(const Mesh& surface);
/// Returns about how many cubes between samples a mesh's surface passes.
double surfaceCubes(const MeshView& mesh, double spacing);
/// Most cubes of a grid that a warning recommends. It takes a few gigabytes.
inline constexpr double kMostAdvisedCubes = 8.0 * double(kMostRepairCubes);
/// Memory of a repair that needs all samples, which is at most about this much of each.
inline constexpr size_t kBytesPerSample = 64;
/// Returns whether a field has all of its samples: a GPU makes no other fields.
bool needsAllSamples(const MachineOptions& machine);

}  // namespace raymap
