#pragma once

#include "io/field/field_array.h"

namespace raymap {

/// Contents of a .npy header (NumPy Enhancement Proposal 1).
struct NpyHeader {
  std::string type;  ///< NumPy's name of the element type, e.g. "<f4".
  bool xFastest = false;
  std::vector<int64_t> shape;
};

/// Reads the header. `path` is used in error messages.
NpyHeader readNpyHeader(const std::filesystem::path& path, const ReadBytes& read);
/// Returns the text of a header, padded so that the array after it starts at a multiple of 64 bytes.
std::string npyHeader(const NpyHeader& header);
std::string npyHeader(const Grid& grid, ElementType type);

/// Returns the layout of the array. Throws `Error(Unsupported)` for other types than those of `ElementType`.
ArrayLayout layoutOf(const std::filesystem::path& path, const NpyHeader& header);

/// Reads the array after `header` into the field and sets the dimensions of its grid. `stored` bounds the
/// array's bytes.
void readNpyArray(const std::filesystem::path& path, Field& field, std::string_view name,
                  const NpyHeader& header, const StoredBytes& stored, const ReadBytes& read);

}  // namespace raymap
