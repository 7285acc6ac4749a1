#pragma once

#include "field_array.h"

namespace raymap {

/// What a .vdb holds, in memory that two processes share; the samples follow it.
struct VdbContents {
  std::array<int64_t, 3> dims{};
  std::array<double, 3> origin{};
  double spacing = 0.0;
  double band = 0.0;
  std::array<char, 16> name{};
  ElementType type = ElementType::Float32;
};

/// Loads OpenVDB's registry; once, whoever calls it.
void initializeVdb();

/// Writes the contents of a .vdb, then its samples, to a file descriptor, on this thread alone. `limit`
/// bounds the bytes of samples. OpenVDB does not survive every damaged file, so that this belongs in a child
/// process.
void copyVdb(const std::filesystem::path& path, uint64_t limit, int descriptor);

}  // namespace raymap
