#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <iosfwd>
#include <string>
#include <vector>

#include "mesh/packed_mesh.h"

namespace raymap {

/// How a format rounds positions.
enum class Precision : uint8_t {
  Single,  ///< To single precision.
  Double,  ///< To double precision.
  Origin,  ///< Not at all: it keeps single precision about a double-precision origin.
};

/// A mesh to write. Positions of a view in double precision are as given, not rounded about the origin.
struct WritableMesh : PackedMesh {
  std::vector<glm::dvec3> exact = {};  ///< Positions of a view in double precision; of others none.

  glm::dvec3 exactPosition(uint32_t vertex) const { return exact.empty() ? position(vertex) : exact[vertex]; }
};

/// Returns the position of a vertex in a file of single precision.
inline glm::vec3 singlePosition(const WritableMesh& mesh, uint32_t vertex) {
  return glm::vec3(mesh.exactPosition(vertex));
}

/// Returns the mesh as a file holds it.
Mesh rounded(const WritableMesh& mesh, Precision precision);

/// Returns a line for the file that says how to move the mesh back; empty for no offset.
std::string offsetNote(const glm::dvec3& offset);

// One writer per format, for `writeMesh`. The mesh is moved already; `offset` is only noted.
void writePly(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset);
void writeObj(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset);
void writeStl(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset);
void writeGlb(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset);

static_assert(std::endian::native == std::endian::little, "files are written in the machine's byte order");

/// Copies a value's bytes to `out`. Returns the position after them.
template <class T>
char* append(char* out, const T& value) {
  std::memcpy(out, &value, sizeof(T));
  return out + sizeof(T);
}

}  // namespace raymap
