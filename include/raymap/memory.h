#pragma once

#include <raymap/export.h>

#include <cstddef>

namespace raymap {

/// Bounds what this process may hold: the program itself, meshes, fields, and all that Raymap makes of them.
/// Work that would exceed the bound throws `Error(Memory)` before it begins. `MachineOptions::memoryLimit`
/// bounds a single call in addition. 0 = no bound. Takes effect for all threads; call it once, early.
///
/// A strict bound also makes every allocation beyond it fail with `std::bad_alloc`, those of the program's
/// own code too. It holds until a GPU's driver is loaded, as drivers map far more than they use. Throws
/// `Error(Memory)` if the process holds more already.
RAYMAP_API void limitMemory(size_t bytes, bool isStrict = false);

/// Returns the number of bytes that this process can still get without swapping. This is the least of the
/// system's available memory and of what `limitMemory`, the control groups and the process's own limits
/// (ulimit) leave, or SIZE_MAX if none is known.
RAYMAP_API size_t memoryLeft();

}  // namespace raymap
