#pragma once

#include <raymap/generate.h>
#include <raymap/repair.h>

#include <optional>

#include "cpu/points/prepared_surface.h"

namespace raymap {

/// The mesh to repair with its options, and what the stages of the repair share. Refers to all of them.
class Given {
 public:
  const PackedMesh mesh;
  const Grid& grid;
  const FieldOptions& options;
  const RepairOptions& repair;
  const MachineOptions& machine;

  Given(const PackedMesh& given, const Grid& lattice, const FieldOptions& fieldOptions,
        const RepairOptions& changes, const MachineOptions& machineOptions)
      : mesh(given), grid(lattice), options(fieldOptions), repair(changes), machine(machineOptions) {}

  /// Returns the mesh's field, and decides which faces are turned. Called first.
  Generated generateSolid();
  /// Returns the field of another mesh on the same device.
  Field generateOther(const MeshView& other, const FieldOptions& different);
  /// Returns the mesh prepared for points, its faces turned as in the field. Prepares it once.
  const cpu::PreparedSurface& surface();

 private:
  Generator generator_;  // It opens the device once.
  Turns turns_;
  std::optional<cpu::PreparedSurface> surface_;
};

}  // namespace raymap
