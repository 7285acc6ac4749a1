#pragma once

#include <raymap/diagnostics.h>
#include <raymap/grid.h>
#include <raymap/machine.h>
#include <raymap/mesh_view.h>
#include <raymap/options.h>
#include <raymap/verdict.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace raymap {

inline constexpr int kRepairResolution = 256;
/// Thinnest wall that no samples miss, in samples. A ball of diameter 1.732 holds one wherever it lies.
inline constexpr double kThinnestWall = 1.75;
/// Most cubes between samples that `fitRepairGrid` lets the surface pass when it chooses by itself: about the
/// area over the square of the spacing. Each becomes two triangles before they are simplified.
inline constexpr size_t kMostRepairCubes = size_t{1} << 19;
/// Most samples that it chooses on a GPU, whose field has all of them.
inline constexpr size_t kMostRepairSamples = size_t{1} << 26;

/// How to change a mesh beside closing it. Lengths are in the mesh's units.
struct RepairOptions {
  /// Whether to measure distances to the surface that closes holes, too; else holes close in steps.
  bool closeHoles = true;
  double offset = 0.0;  ///< Distance to move the surface outwards, in the mesh's units; negative: inwards.
  double shell = 0.0;   ///< Thickness of the walls of a hollow solid, in the mesh's units; 0 = not hollow.
  /// Least thickness of walls, fins and sheets: what is thinner in the mesh becomes a plate this thick. At
  /// least two samples, or 0 = none: what samples miss is lost. Unset: 1.75 samples, the thinnest
  /// wall that the grid cannot miss. Material removed by a negative offset is not restored.
  std::optional<double> minThickness = {};
  double drainHole = 0.0;  ///< Diameter of the drain holes; 0 = none.
  /// Number of drain holes of each hollow: down from its lowest point, then as a vent up from its highest
  /// one, then down from level floors as far from the others as there are.
  int drainHoles = 1;
  glm::dvec3 down{0.0, 0.0,
                  -1.0};  ///< Direction of the drain holes and of the walls to a base; any length but 0.
  /// Volume in the mesh's units cubed. Parts of the result that enclose less are dropped. Unset: a thousandth
  /// of what the largest part encloses. A small part is kept if no other part covers that piece of the mesh.
  std::optional<double> dropSmaller = {};
  /// Height against `down` of a flat base that walls join the rim of the mesh to, as for a terrain. The mesh
  /// must not reach below it. By default there is none.
  std::optional<double> base = {};
  bool keepCavities =
      false;            ///< Whether to keep sealed cavities; else they are filled, with all parts in them.
  bool remesh = false;  ///< Whether to make all faces from the field even if some could be kept.
  /// Largest deviation of the result from the isosurface, in the mesh's units, to have fewer faces; 0 = all
  /// faces. By default a tenth of the distance between samples, or what `triangles` needs. Faces that could
  /// be kept are simplified only if it is given.
  std::optional<double> tolerance = {};
  /// Most triangles of the result, 0 = no limit. The tolerance is then the least that was found to reach this
  /// number, and `tolerance` limits it. Faces that could be kept are simplified, too.
  size_t triangles = 0;
  /// Plane of a cut: what lies on the side of its normal is removed.
  std::optional<Plane> cutPlane = {};
  /// Called with the result before it is measured, for example to round it as a file does; again
  /// after a cut.
  std::function<void(Mesh&)> roundResult = {};
  /// Whether to measure both meshes and how far they deviate; takes longer. Without, nothing in the report is
  /// set that compares the meshes or tells what is wrong with them.
  bool measure = true;
};

/// How far points of one surface lie from where they should, in the mesh's units.
struct Deviation {
  double max = 0.0;   ///< Largest distance.
  double mean = 0.0;  ///< Mean distance over the area of the surface.
  double p99 = 0.0;   ///< Distance that 99 % of the area do not exceed.
  size_t points = 0;  ///< Number of points measured.
};

/// Place of a drain hole.
struct DrainHolePlace {
  glm::dvec3 position{0.0};   ///< Point where its axis leaves the solid, in the mesh's units.
  glm::dvec3 direction{0.0};  ///< Its direction there, of length 1.
};

/// Parts or cavities that the result lacks. Volumes are what their surfaces enclose, in the mesh's units
/// cubed.
struct Removed {
  size_t count = 0;      ///< Number of them.
  double volume = 0.0;   ///< Sum of the volumes.
  double largest = 0.0;  ///< Volume of the largest one.
};

/// Parts of the mesh that a repair loses: those of its solid that are too thin for the samples, and surface
/// that bounds no solid.
struct Loss {
  double solidShare = 0.0;       ///< Share of the mesh's area that is lost and bounds such a part.
  Box bounds = {};               ///< Bounds of this area, moved by the offset. Empty if there are none.
  double thinnest = 0.0;         ///< Thickness at its thinnest point, with the offset.
  double medianThickness = 0.0;  ///< Median thickness over this area; 0 if it is not known.
  /// Largest distance between samples that was found to keep the parts, in the mesh's units. If none does,
  /// the one that keeps most of them; 0 = none keeps any.
  double voxelSize = 0.0;
  bool kept = false;           ///< Whether `voxelSize` keeps the parts: all but 0.5 % of the area.
  double keptShare = 0.0;      ///< Share of the lost area that `voxelSize` keeps.
  double keptThickness = 0.0;  ///< Median thickness of the parts that it does not keep.
  /// Share of the mesh's area that is lost with parts below `RepairOptions::dropSmaller`.
  double droppedShare = 0.0;
  Box droppedBounds = {};  ///< Bounds of this area. Empty if there is none.
  /// Share of the mesh's area that is lost and bounds nothing: sheets, open surface.
  double openShare = 0.0;
  Box openBounds = {};  ///< Bounds of this area. Empty if there is none.
};

/// How a mesh was simplified; by a repair the isosurface, or the faces that were kept.
struct SimplifyReport {
  double tolerance = 0.0;      ///< Tolerance in force, in the mesh's units; 0 = not simplified.
  size_t trianglesBefore = 0;  ///< Number of triangles before.
  size_t trianglesAfter = 0;   ///< Number of triangles of the result.
  double deviation = 0.0;      ///< Largest distance measured, from points of either mesh to the other.
};

/// Changes that a repair made, and how far the result is from the mesh.
struct RepairReport {
  Stats stats = {};                       ///< Cost of the field, then of the stages after it.
  Diagnostics before = {};                ///< Diagnostics of the given mesh.
  Diagnostics after = {};                 ///< Diagnostics of the result.
  SelfIntersections crossingBefore = {};  ///< Faces that cross in the given mesh.
  SelfIntersections crossingAfter = {};   ///< Faces that cross in the result.
  Arrangement arrangementBefore =
      Arrangement::Unknown;  ///< How the closed parts of the given mesh lie to each other.
  Arrangement arrangementAfter = Arrangement::Unknown;  ///< The same of the result.
  /// From points of the result to the given surface, moved by the offset, or to the hollow's surface. Drain
  /// holes are left out.
  Deviation resultFromMesh = {};
  Deviation meshFromResult = {};  ///< From points of the given mesh, moved by the offset, to the result.
                                  ///< Includes lost points; excludes buried ones.
  Deviation keptFromResult = {};  ///< The same without the lost points.
  /// Share of the mesh's area more than a sample inside the result; where parts were united, all inside it.
  /// A tolerance above the default allows as much more, here and in `lostShare`.
  double buriedShare = 0.0;
  double lostShare = 0.0;  ///< Share of it more than a sample outside: thinner than the samples, or open.
  /// Share of the mesh's area that the offset removes, where other parts are closer. All other shares are
  /// relative to what remains.
  double trimmedShare = 0.0;
  Loss loss = {};            ///< Parts of the lost share, and what would keep them.
  size_t filledHollows = 0;  ///< Number of hollows that a drain hole does not fit into; they are solid.
  size_t hollows = 0;        ///< Number of hollows that the shell left.
  size_t drainHoles = 0;     ///< Number of drain holes.
  std::vector<DrainHolePlace> drainHolePlaces = {};  ///< Places of the drain holes, hollow by hollow.
  size_t solids = 0;          ///< Number of parts of the result; those in cavities, too.
  size_t cavities = 0;        ///< Number of sealed cavities of the result: those of the shell, too.
  double dropSmaller = 0.0;   ///< Volume below which parts were dropped.
  Removed dropped = {};       ///< Parts that were too small.
  Removed filled = {};        ///< Sealed cavities that were filled.
  Removed buried = {};        ///< Parts in cavities that were filled.
  bool partsOverlap = false;  ///< Whether parts overlap, touch or nest wrongly, and all else is right.
  /// How much was changed. Faces that stay may also be simplified. `stats.turnedFaces` has those that were
  /// reversed.
  RepairDepth depth = RepairDepth::Field;
  FieldReason fieldReason = FieldReason::None;  ///< Why the faces are those of a field.
  /// Number of degenerate and repeated faces that were removed, or replaced together with a neighbour, so
  /// that the other faces could be kept.
  size_t cleanedFaces = 0;
  /// Number of faces that were cut where they cross, overlap or touch others, so that the faces that bound
  /// the union could be kept. 0 also if no face was, but parts in others went.
  size_t unitedFaces = 0;
  size_t sewnVertices = 0;  ///< Number of vertices that were joined to others across cracks.
  /// Number of vertices that were moved, by at most 1.3e-4 of the mesh's size, so that no faces cross once
  /// they are rounded.
  size_t movedVertices = 0;
  /// Number of faces of parts that keep them, mended where that was needed, while the rest of the mesh became
  /// a field. The deviations are those of the rest.
  size_t keptFaces = 0;
  size_t closedHoles = 0;       ///< Number of holes that faces were added to close, before anything else.
  size_t closingFaces = 0;      ///< Number of these faces, with the walls to a base.
  double leastThickness = 0.0;  ///< Thickness of the plates in place of thinner parts; 0 = none made.
  double thickenedShare = 0.0;  ///< Share of the mesh's area that was thinner, and is on plates.
  std::vector<Warning> warnings = {};  ///< Warnings, in the order in which they were found.
  SimplifyReport simplified = {};      ///< All 0 if faces were kept as they were.

  /// Returns whether the mesh's own faces were kept or simplified.
  bool keepsFaces() const { return depth != RepairDepth::Field; }
};

/// A repaired mesh and what was done.
struct Repaired {
  Mesh mesh = {};
  RepairReport report = {};
  /// Given triangle that each triangle of `mesh` is, or is a part of; `kNoTriangle` for those that were
  /// added. Empty if all triangles were made from the field or simplified.
  std::vector<uint32_t> faceSource = {};
  Mesh cutOff = {};  ///< The part that `RepairOptions::cutPlane` removes, closed as the result is.
  std::vector<uint32_t> cutOffSource = {};  ///< The same as `faceSource` for `cutOff`.
};

/// A grid for a repair, and the thickness that chose the distance between its samples.
struct RepairGrid : Grid {
  /// Thickness of the mesh's thinnest part (`Verdict::thinnest`), or of a hollow's walls or drain holes if
  /// that is less. Nothing if it is at least two samples of `kRepairResolution`, or was not measured.
  std::optional<double> thinnest = {};
  double surfaceCubes =
      0.0;  ///< Cubes between samples that the mesh's surface passes, estimated by its area.

  /// Returns whether the samples are dense enough for that part: without plates in its place.
  bool keepsThinnest() const { return !thinnest || spacing <= 0.5 * *thinnest; }
};

/// Returns a grid that holds the result: it covers the mesh's bounds, padded by `GridOptions::padding` and by
/// a positive offset or half the least thickness, whichever is more. Ignores `GridOptions::box`, `dims` and
/// `thickness`.
///
/// Covers the base, too. Without a resolution or a voxel size, it has `kRepairResolution` samples along its
/// longest side. They are as dense as two to the thinnest part if that takes at most `kMostRepairCubes`, with
/// a shell half of them, on a GPU at most `kMostRepairSamples`, and memory within `machine.memoryLimit`. A
/// soup of faces (`MeshKind::Soup`) has 128 samples along its longest side. Uses `machine` and throws `Error`
/// as `fitGrid` and `judge` do.
RAYMAP_API RepairGrid fitRepairGrid(const MeshView& mesh, const GridOptions& options = {},
                                    const RepairOptions& repair = {}, const MachineOptions& machine = {});

/// Returns the same grid for a mesh that `judge` has judged, with its thickness.
RAYMAP_API RepairGrid chooseRepairGrid(const MeshView& mesh, const Verdict& verdict,
                                       const GridOptions& options = {}, const RepairOptions& repair = {},
                                       const MachineOptions& machine = {});

/// Returns how thick the thinnest part of a mesh is, and what a repair on the grid that it chooses keeps of
/// it, in whole sentences. `judge` made the verdict, with the thickness. Empty if the mesh is no solid.
RAYMAP_API std::string describeThickness(const MeshView& mesh, const Verdict& verdict,
                                         const MachineOptions& machine = {});

/// Returns a watertight solid in place of any mesh: the isosurface of its field on `grid`, which must hold
/// the result. Keeps the faces of a mesh with nothing wrong that needs no change; also of one in which
/// leaving out degenerate and repeated faces, turning faces back, cutting faces where they meet others,
/// making plates of sheets, and with `closeHoles` filling holes, leaves nothing wrong. Else fills what a
/// plane closes before it makes the field; deviations are then measured from the mesh with these faces. Parts
/// that are apart, or closed solids, and can be mended, keep their faces also beside a field of the rest.
///
/// A cut comes last, so it adds to `RepairOptions::triangles`, and shares of lost area are those before it.
/// It leaves both parts closed by flat faces.
///
/// `options` say how distance and sign are found. All of `machine` is used. The field is a narrow band, made
/// on the CPU; it has all samples, made on `device`, if `device` names a GPU, for another distance or sign
/// than the default, and of an open mesh on up to 2^24 samples. Throws `Error` as `generate` and `isosurface`
/// do. Usage also for options that make no sense for a solid: no sign, `band`, `invert`, `thickness`,
/// `closeHoles` and further arrays; and if walls, holes or the least thickness are thinner than two samples.
RAYMAP_API Repaired repair(const MeshView& mesh, const Grid& grid, const FieldOptions& options = {},
                           const RepairOptions& repair = {}, const MachineOptions& machine = {});

}  // namespace raymap
