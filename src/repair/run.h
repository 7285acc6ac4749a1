#pragma once

#include <raymap/generate.h>
#include <raymap/local_thickness.h>
#include <raymap/repair.h>

#include <optional>
#include <vector>

#include "base/memory.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "cpu/points/prepared_surface.h"
#include "mesh/model.h"
#include "repair/solid/deviation.h"
#include "repair/solid/hollow.h"
#include "repair/topology/mend.h"

namespace raymap {

/// Parts of a mesh that keep their faces, as they are apart from the rest, which becomes a field.
struct KeptParts {
  Mesh mesh = {};                      ///< Their faces, mended and united.
  std::vector<uint32_t> sources = {};  ///< Given face that each is a part of; `kNoTriangle` if none.
  std::vector<uint32_t> rest = {};     ///< Face of the whole mesh that each face of the rest is.
  double share = 0.0;                  ///< Share of the mesh's area.
};

/// A repair under way: what it is given, and what each stage hands to the next. repair/pipeline.h has the
/// order of the stages. Refers to the given mesh, grid and options.
class RepairRun {
 public:
  RepairRun(const MeshView& mesh, const Grid& lattice, const FieldOptions& signOptions,
            const RepairOptions& changes, const MachineOptions& machineOptions);
  RepairRun(const RepairRun&) = delete;

  const Model given;
  const Grid& grid;
  const FieldOptions& fieldOptions;
  const RepairOptions& options;
  MachineOptions machine;
  Progress progress;

  Repaired repaired;
  Mesh& result = repaired.mesh;
  RepairReport& report = repaired.report;
  Mended mended;                 ///< The given mesh with what was certain mended; empty if that is nothing.
  KeptParts kept;                ///< Parts that `mended` does not have, or nothing.
  Field solid;                   ///< Its field, moved by the offset: a narrow band, or dense.
  bool isCut = false;            ///< Whether the box of the samples cuts a surface off.
  Mesh dropped;                  ///< Surface of the parts that were dropped on request.
  ExpectedPoints expected;       ///< Points that the result should show.
  std::vector<DrainHole> holes;  ///< Drain holes.
  std::vector<FacePoint> lost;   ///< Expected points that the result does not show.
  double lostShare = 0.0;        ///< Share of the mesh's area that they stand for.

  /// Does the work of a stage, and takes its time.
  template <class Work>
  void stage(const char* name, Work&& work) {
    progress.stage(name, [&] { withThreads(machine.threads, work); });
  }
  /// Returns the mesh that the result shall show.
  PackedMesh mesh() const {
    return mended.isChanged() || kept.share > 0.0 ? PackedMesh(mended.mesh) : PackedMesh(given);
  }
  /// Returns the share of the mesh's area that becomes a field.
  double fieldShare() const { return 1.0 - kept.share; }
  /// Makes the mesh's field, moved by the offset, and decides which faces are turned.
  void makeSolid();
  /// Makes the field of the result: of what is left after parts were dropped or filled.
  void makeSolidAgain();
  /// Returns the field of another mesh on the same device.
  Field fieldOf(const MeshView& other, const FieldOptions& different);
  /// Returns the mesh prepared for points, its faces turned as in the field. Prepares it once.
  const cpu::PreparedSurface& surface();
  /// Returns the most bytes that the repair and what is made next may hold.
  size_t most() const { return mostMemory(machine.memoryLimit, solid.bytes()); }

 private:
  /// Returns whether the field shall have all of its samples.
  bool isDense() const;
  void makeDense(const FieldOptions& how);
  void makeBand();
  /// Reports what a field cost, and which faces it turned.
  void take(Stats stats);

  Generator generator_;  // It opens the device once.
  Turns turns_;
  std::optional<cpu::PreparedSurface> surface_;
};

}  // namespace raymap
