#pragma once

// Interface between the pipeline and its backends.

#include <raymap/field.h>
#include <raymap/machine.h>
#include <raymap/options.h>

#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "mesh/double_sided.h"
#include "mesh/model.h"
#include "method/cell_mesh.h"
#include "method/close_holes_shared.h"
#include "method/orientation_sheets.h"
#include "method/turns.h"

namespace raymap {

/// Input, output and progress of a run. Holds references only.
struct Job {
  const Model& mesh;
  const Grid& grid;
  const FieldOptions& options;
  Progress& progress;
  Field& field;
  const MachineOptions& machine = kAnyMachine;

  static inline const MachineOptions kAnyMachine = {};
};

/// Backend of the pipeline, with one function per stage. It holds the mesh, the grid, the options and every
/// intermediate result.
template <class B>
concept Backend = requires(B b, const char* name, void (*work)()) {
  { b.options() } -> std::same_as<const FieldOptions&>;
  b.stage(name, work);  // Runs the work, timed and reported under the name.
  b.begin();
  b.voxelGrid();
  b.cellDistance();
  b.distanceTransform();
  b.refine();
  b.rasterDistance();
  b.exactDistance();
  b.crossings();
  b.rayMap();
  b.winding(SignMode::Harmonic);
  b.windingDipoles();
  b.sign();
  b.finish();
  { b.complete() } -> std::same_as<bool>;  // False if lists outgrew their memory, which has grown: run again.
};

/// A backend whose intermediate results the host can read between the stages.
template <class B>
concept HostBackend = Backend<B> && requires(B b, const Turns& turns, std::span<const glm::vec3> points) {
  { b.mesh() } -> std::same_as<const Model&>;
  { b.progress() } -> std::same_as<Progress&>;
  { b.spacing() } -> std::same_as<double>;        // Sample spacing in the mesh's units.
  { b.doubtfulShare() } -> std::same_as<double>;  // Share of samples whose six rays disagree.

  // For the stage `orientation`, which leaves its result in `faceSides`.
  b.faceSides();
  { b.doubleSidedFaces() } -> std::convertible_to<DoubleSidedFaces>;  // Valid before any face is turned.
  b.turnFaces(turns);
  { b.misfit() } -> std::same_as<double>;
  { b.contradictsParity() } -> std::same_as<bool>;  // Valid after `misfit`.
  { b.rises() } -> std::same_as<std::span<const float>>;
  { b.parityRises() } -> std::same_as<std::span<const float>>;
  { b.nearSides() } -> std::same_as<NearSides>;

  // For the stage `close_holes`, which leaves its result in `patch`.
  b.patch();
  { b.missingEdges() } -> std::same_as<std::vector<MissingEdge>>;
  { b.windingAt(points) } -> std::same_as<std::vector<float>>;
  { b.cellMesh() } -> std::same_as<const CellMesh&>;
  { b.bytesLeft() } -> std::same_as<size_t>;
  { B::patchTreeBytes(size_t{}) } -> std::same_as<size_t>;  // For so many triangles.
  b.addPatch();
};

}  // namespace raymap
