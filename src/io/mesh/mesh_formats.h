#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "mesh/attribute_words.h"
#include "mesh/packed_mesh.h"

namespace raymap {

/// How a format rounds positions.
enum class Precision : uint8_t {
  Single,  ///< To single precision.
  Double,  ///< To double precision.
  Origin,  ///< Not at all: it keeps single precision about a double-precision origin.
};

/// Values of corners by vertex, as formats hold them that have one for each vertex.
struct VertexValues {
  std::vector<uint32_t> ids = {};  ///< First value of each vertex, or `kNoAttribute`. Empty: no values.
  bool differ = false;             ///< Whether the corners at a vertex have several.
};

/// A mesh to write. Positions of a view in double precision are as given, not rounded about the origin.
struct WritableMesh : PackedMesh {
  std::vector<glm::dvec3> exact = {};          ///< Positions of a view in double precision; of others none.
  const MeshAttributes* attributes = nullptr;  ///< `MeshWriteOptions::attributes`.
  VertexValues uvs = {}, colours = {};
  std::vector<uint32_t> partOf = {};  ///< Result of `separateParts`, if the format has objects.
  std::filesystem::path folder = {};  ///< Folder of the file.

  glm::dvec3 exactPosition(uint32_t vertex) const { return exact.empty() ? position(vertex) : exact[vertex]; }
};

/// Returns the position of a vertex in a file of single precision.
inline glm::vec3 singlePosition(const WritableMesh& mesh, uint32_t vertex) {
  return glm::vec3(mesh.exactPosition(vertex));
}

/// Returns the colour of a vertex; white if it has none.
glm::vec4 colourOf(const WritableMesh& mesh, uint32_t vertex);

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
