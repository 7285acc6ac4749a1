#include <charconv>
#include <ostream>

#include "io/mesh/mesh_formats.h"

namespace raymap {

namespace {

/// Writes a keyword and three numbers, each with the fewest digits that read back exactly.
template <class T>
void writeLine(std::ostream& out, char keyword, const glm::vec<3, T>& numbers) {
  constexpr size_t kLongest = 32;  // Longest number, in characters.
  char line[2 + 3 * (1 + kLongest)];
  char* at = line;
  *at++ = keyword;
  for (int c = 0; c < 3; ++c) {
    *at++ = ' ';
    at = std::to_chars(at, at + kLongest, numbers[c]).ptr;
  }
  *at++ = '\n';
  out.write(line, at - line);
}

}  // namespace

void writeObj(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset) {
  if (const std::string note = offsetNote(offset); !note.empty()) out << "# " << note << "\n";
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) writeLine(out, 'v', mesh.exactPosition(v));
  for (const glm::uvec3& face : mesh.triangles) writeLine(out, 'f', glm::u64vec3(face) + glm::uint64_t{1});
}

}  // namespace raymap
