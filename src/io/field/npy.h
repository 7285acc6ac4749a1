#pragma once

#include "io/field/field_array.h"

namespace raymap {

/// What the header of a .npy says (NumPy Enhancement Proposal 1).
struct NpyHeader {
  std::string type;  ///< NumPy's name for it, e.g. "<f4".
  bool xFastest = false;
  std::vector<int64_t> shape;
};

/// Reads the header; `path` is for its errors.
NpyHeader readNpyHeader(const std::filesystem::path& path, const ReadBytes& read);
/// A header whose length leaves the array aligned.
std::string npyHeader(std::string_view type, std::string_view shape);
std::string npyHeader(const Grid& grid, ElementType type);

/// Reads the array after `header` into the field, whose grid gets its dimensions; `available` bounds its
/// bytes.
void readNpyArray(const std::filesystem::path& path, Field& field, std::string_view name,
                  const NpyHeader& header, uint64_t available, const ReadBytes& read);

}  // namespace raymap
