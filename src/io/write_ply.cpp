#include <raymap/error.h>
#include <raymap/io.h>

#include <bit>
#include <cstring>
#include <ostream>

#include "atomic_file.h"

namespace raymap {

namespace {

static_assert(std::endian::native == std::endian::little, "the file is written in the machine's byte order");

template <class T>
char* append(char* out, const T& value) {
  std::memcpy(out, &value, sizeof(T));
  return out + sizeof(T);
}

}  // namespace

void writeMesh(const std::filesystem::path& path, const Mesh& mesh) {
  if (path.extension() != ".ply")
    throw Error(ErrorCode::Usage, path.string() + ": meshes are written as .ply only");
  writeAtomically(path, [&](std::ostream& out) {
    // Double precision: a vertex is a float about a double-precision origin.
    out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.vertices.size()
        << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << mesh.triangles.size()
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
      char bytes[sizeof(glm::dvec3)];
      append(bytes, mesh.position(v));
      out.write(bytes, sizeof(bytes));
    }
    for (const glm::uvec3& face : mesh.triangles) {
      char bytes[1 + sizeof(glm::uvec3)];
      append(append(bytes, uint8_t{3}), face);
      out.write(bytes, sizeof(bytes));
    }
  });
}

}  // namespace raymap
