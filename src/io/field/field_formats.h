#pragma once

#include <raymap/narrow_band.h>

#include "io/field/field_array.h"

#include <cstdint>
#include <iosfwd>
#include <span>

// One reader and one writer per format, for `readField` and `writeField`. Readers add the names of the arrays
// that they leave out. The arrays passed to writers fit the grid. A frame needs no samples.

namespace raymap {

using LeftOut = std::vector<std::string>;

/// The bytes of a file before the samples of each of its arrays, and after the last one.
struct Frame {
  std::vector<std::string> before;
  std::string tail = {};
};

Field readNrrd(const SourceFile& source, LeftOut& leftOut);
void writeNrrd(std::ostream& out, const Field& field, const NamedArray& array);
Frame frameNrrd(const Field& about, std::span<const NamedArray> array);

Field readNpy(const SourceFile& source, LeftOut& leftOut);
void writeNpy(std::ostream& out, const Field& field, const NamedArray& array);
void writeHalfNpy(std::ostream& out, const Field& field, const NamedArray& array);
Frame frameNpy(const Field& about, std::span<const NamedArray> array);

Field readNpz(const SourceFile& source, LeftOut& leftOut);
void writeNpz(std::ostream& out, const Field& field, const NamedArray& array);
void writeHalfNpz(std::ostream& out, const Field& field, const NamedArray& array);

Field readVti(const SourceFile& source, LeftOut& leftOut);
void writeVti(std::ostream& out, const Field& field, const NamedArray& array);
Frame frameVti(const Field& about, std::span<const NamedArray> arrays);

/// Which grid of a file of several is read, and how.
struct GridChoice {
  std::string_view name;  ///< Empty: the first level set.
  /// A level set with more samples becomes a narrow band. If 0, all that is no level set is refused.
  uint64_t mostDense = UINT64_MAX;
};

/// Returns the name of the grid that holds an array of one of several bands: "body.winding".
inline std::string arrayGridName(std::string_view band, std::string_view array) {
  return std::string(band) + "." + std::string(array);
}

Field readVdb(const SourceFile& source, LeftOut& leftOut, const GridChoice& grid);
Field readNvdb(const SourceFile& source, LeftOut& leftOut, const GridChoice& grid);
/// How a .vdb or .nvdb stores an array.
struct VdbStorage {
  std::string_view gridName;  ///< Empty: that of the array.
  bool half = false;          ///< Whether numbers that are not whole take 16 bits.
  bool inSteps = false;       ///< Whether these are equal steps of the range of their leaf, as in a .nvdb.
};

/// Writes fields with the names of their grids, and narrow bands with all their arrays.
struct VdbWriter {
  void (*field)(std::ostream& out, const Field& field, const NamedArray& array, const VdbStorage& storage);
  void (*bands)(std::ostream& out, std::span<const NamedField> bands, const VdbStorage& storage);
};

// Load the writers. Throw `Error`: Unsupported if their library is missing, Memory.
const VdbWriter& vdbWriter();
const VdbWriter& nvdbWriter();

}  // namespace raymap
