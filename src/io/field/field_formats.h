#pragma once

#include "io/field/field_array.h"

#include <iosfwd>

// One reader and one writer per format, for `readField` and `writeField`. The arrays passed to writers fit
// the grid.

namespace raymap {

Field readNrrd(const std::filesystem::path& path);
void writeNrrd(std::ostream& out, const Field& field, const NamedArray& array);

Field readNpy(const std::filesystem::path& path);
void writeNpy(std::ostream& out, const Field& field, const NamedArray& array);

Field readNpz(const std::filesystem::path& path);
void writeNpz(std::ostream& out, const Field& field, const NamedArray& array);

Field readVti(const std::filesystem::path& path);
void writeVti(std::ostream& out, const Field& field, const NamedArray& array);

Field readVdb(const std::filesystem::path& path);
void writeVdb(std::ostream& out, const Field& field, const NamedArray& array);

}  // namespace raymap
