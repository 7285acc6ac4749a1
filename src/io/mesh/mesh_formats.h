#pragma once

#include <bit>
#include <cstring>
#include <iosfwd>

#include "mesh/packed_mesh.h"

namespace raymap {

// One writer per format, for `writeMesh`.
void writePly(std::ostream& out, const PackedMesh& mesh);
void writeObj(std::ostream& out, const PackedMesh& mesh);
void writeStl(std::ostream& out, const PackedMesh& mesh);
void writeGlb(std::ostream& out, const PackedMesh& mesh);

static_assert(std::endian::native == std::endian::little, "files are written in the machine's byte order");

/// Copies a value's bytes to `out`. Returns the position after them.
template <class T>
char* append(char* out, const T& value) {
  std::memcpy(out, &value, sizeof(T));
  return out + sizeof(T);
}

}  // namespace raymap
