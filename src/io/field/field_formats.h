#pragma once

#include "io/field/field_array.h"

#include <iosfwd>

// One reader and one writer per format, for `readField` and `writeField`. The arrays passed to writers fit
// the grid.

namespace raymap {

Field readNrrd(const SourceFile& source);
void writeNrrd(std::ostream& out, const Field& field, const NamedArray& array);

Field readNpy(const SourceFile& source);
void writeNpy(std::ostream& out, const Field& field, const NamedArray& array);

Field readNpz(const SourceFile& source);
void writeNpz(std::ostream& out, const Field& field, const NamedArray& array);

Field readVti(const SourceFile& source);
void writeVti(std::ostream& out, const Field& field, const NamedArray& array);

Field readVdb(const SourceFile& source);
void writeVdb(std::ostream& out, const Field& field, const NamedArray& array);

}  // namespace raymap
