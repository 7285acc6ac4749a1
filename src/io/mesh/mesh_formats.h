#pragma once

#include <raymap/mesh.h>

#include <bit>
#include <cstring>
#include <iosfwd>

namespace raymap {

// One writer per format, for `writeMesh`.
void writePly(std::ostream& out, const Mesh& mesh);
void writeObj(std::ostream& out, const Mesh& mesh);
void writeStl(std::ostream& out, const Mesh& mesh);
void writeGlb(std::ostream& out, const Mesh& mesh);

static_assert(std::endian::native == std::endian::little, "files are written in the machine's byte order");

/// Copies a value's bytes to `out`. Returns the position after them.
template <class T>
char* append(char* out, const T& value) {
  std::memcpy(out, &value, sizeof(T));
  return out + sizeof(T);
}

}  // namespace raymap
