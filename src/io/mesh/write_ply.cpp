#include <ostream>

#include "io/mesh/mesh_formats.h"

namespace raymap {

void writePly(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset) {
  // Double precision holds every position: of a view, or a float relative to a double-precision origin.
  out << "ply\nformat binary_little_endian 1.0\n";
  if (const std::string note = offsetNote(offset); !note.empty()) out << "comment " << note << "\n";
  out << "element vertex " << mesh.vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << mesh.triangles.size()
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    char bytes[sizeof(glm::dvec3)];
    append(bytes, mesh.exactPosition(v));
    out.write(bytes, sizeof(bytes));
  }
  for (const glm::uvec3& face : mesh.triangles) {
    char bytes[1 + sizeof(glm::uvec3)];
    append(append(bytes, uint8_t{3}), face);
    out.write(bytes, sizeof(bytes));
  }
}

}  // namespace raymap
