#pragma once

#include <raymap/export.h>
#include <raymap/field.h>
#include <raymap/machine.h>
#include <raymap/mesh_view.h>
#include <raymap/options.h>

#include <memory>

namespace raymap {

/// A field and what it cost.
struct Generated {
  Field field = {};
  Stats stats = {};
};

// The same mesh, grid and options on the same device give the same field bit for bit, for any number of
// threads. The CPU and each GPU round differently, so their fields differ in the last bits. "auto" may choose
// another device on another machine, with another driver, or when a GPU fails: name the device where bits
// matter.

/// Makes fields and keeps its memory and its device between calls, for meshes that change every frame. Used
/// by one thread at a time.
class RAYMAP_API Generator {
 public:
  Generator();
  ~Generator();
  Generator(Generator&&) noexcept;
  Generator& operator=(Generator&&) noexcept;

  /// Returns a new field. All of `machine` is used. It warns when "auto" falls back to the CPU.
  Generated generate(const MeshView& mesh, const Grid& grid, const FieldOptions& options = {},
                     const MachineOptions& machine = {});

  /// Fills `field`, reusing its memory. Throws `Error`: Input (see `validate`), Usage for options that
  /// contradict each other, Memory, Cancelled, Unsupported or DeviceLost for the device; the field is then
  /// empty.
  Stats generate(const MeshView& mesh, const Grid& grid, const FieldOptions& options, Field& field,
                 const MachineOptions& machine = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns a field made by a generator of its own. Throws as `Generator::generate` does.
RAYMAP_API Generated generate(const MeshView& mesh, const Grid& grid, const FieldOptions& options = {},
                              const MachineOptions& machine = {});

}  // namespace raymap
