#pragma once

#include <raymap/sparse_field.h>

#include "io/field/field_array.h"

#include <iosfwd>

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
Frame frameNpy(const Field& about, std::span<const NamedArray> array);

Field readNpz(const SourceFile& source, LeftOut& leftOut);
void writeNpz(std::ostream& out, const Field& field, const NamedArray& array);

Field readVti(const SourceFile& source, LeftOut& leftOut);
void writeVti(std::ostream& out, const Field& field, const NamedArray& array);
Frame frameVti(const Field& about, std::span<const NamedArray> arrays);

Field readVdb(const SourceFile& source, LeftOut& leftOut);
/// How a .vdb stores an array.
struct VdbStorage {
  std::string_view gridName;  ///< Empty: that of the array.
  bool half = false;          ///< Whether numbers that are not whole take 16 bits.
};

void writeVdb(std::ostream& out, const Field& field, const NamedArray& array, const VdbStorage& storage);
/// Writes a narrow band with all its arrays.
void writeVdb(std::ostream& out, const SparseField& band, const VdbStorage& storage);

}  // namespace raymap
