#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "io/field/field_formats.h"

// `raymap-vdb.plugin` holds OpenVDB and the writers of .vdb and .nvdb. It is loaded when the first file is
// written: the dynamic loader takes 40 ms for OpenVDB, four times as long as for all else.

namespace raymap {

/// Functions of the library that loads the module: the module has no copy of what they know.
struct VdbHost {
  int version;        ///< `RAYMAP_VERSION`.
  size_t fieldBytes;  ///< Size of a `Field`.
  void (*parallelFor)(size_t count, size_t grain, FunctionView<size_t, size_t> work);
  void (*withCallersThreads)(FunctionView<> work);
  void (*checkFormatMemory)(uint64_t bytes);
  std::vector<NamedArray> (*arraysWith)(const Field& field, const NamedArray& asked);
  float (*largestMagnitude)(std::span<const float> values);
};

struct VdbWriters {
  VdbWriter vdb, nvdb;
};

inline constexpr const char* kVdbModule = "raymap-vdb.plugin";
/// Name of the module's only function for others: `const VdbWriters*(const VdbHost&)`. It returns null for a
/// library of another version.
inline constexpr const char* kVdbEntry = "raymapVdbWriters";

// In the module alone.
const VdbHost& vdbHost();
extern const VdbWriters kVdbWriters;

}  // namespace raymap
