#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "io/field/field_array.h"
#include "io/field/field_formats.h"

// `raymap-vdb.plugin` holds OpenVDB and the writers of .vdb and .nvdb. It is loaded when the first file is
// written: the dynamic loader takes 40 ms for OpenVDB, ten times as long as for all else.

namespace raymap {

/// Functions of this library that the module calls: it has no copy of what they know.
struct VdbHost {
  int version;        ///< `RAYMAP_VERSION`.
  size_t fieldBytes;  ///< Size of a `Field`.
  void (*parallelFor)(size_t count, size_t grain, FunctionView<size_t, size_t> work);
  void (*withCallersThreads)(FunctionView<> work);
  void (*checkFormatMemory)(uint64_t bytes);
  std::vector<NamedArray> (*arraysWith)(const Field& field, const NamedArray& asked);
  float (*largestMagnitude)(std::span<const float> values);
};

/// The writers of the module; see field_formats.h.
struct VdbWriters {
  void (*vdb)(std::ostream& out, const Field& field, const NamedArray& array, const VdbStorage& storage);
  void (*vdbBands)(std::ostream& out, std::span<const NamedField> bands, const VdbStorage& storage);
  void (*nvdb)(std::ostream& out, const Field& field, const NamedArray& array, const VdbStorage& storage);
  void (*nvdbBands)(std::ostream& out, std::span<const NamedField> bands, const VdbStorage& storage);
};

inline constexpr const char* kVdbModule = "raymap-vdb.plugin";
/// Name of the module's only function for others: `const VdbWriters*(const VdbHost&)`. It returns null for a
/// library of another version.
inline constexpr const char* kVdbEntry = "raymapVdbWriters";

}  // namespace raymap
