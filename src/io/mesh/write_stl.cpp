#include <raymap/error.h>

#include <ostream>
#include <string>

#include "io/mesh/mesh_formats.h"

namespace raymap {

void writeStl(std::ostream& out, const WritableMesh& mesh, const glm::dvec3& offset) {
  constexpr size_t kHeaderBytes = 80, kFacetBytes = 50;
  if (mesh.triangles.size() > UINT32_MAX)
    throw Error(ErrorCode::Unsupported, "an STL holds 2^32 triangles at most; write a .ply");
  std::string header = "binary STL";  // Not "solid": some readers would take it for text.
  const std::string note = ", " + offsetNote(offset);
  if (offset != glm::dvec3(0.0) && header.size() + note.size() <= kHeaderBytes) header += note;
  header.resize(kHeaderBytes, ' ');
  char count[sizeof(uint32_t)];
  append(count, static_cast<uint32_t>(mesh.triangles.size()));
  out.write(header.data(), kHeaderBytes).write(count, sizeof(count));
  for (const glm::uvec3& face : mesh.triangles) {
    const glm::vec3 a = singlePosition(mesh, face.x), b = singlePosition(mesh, face.y),
                    c = singlePosition(mesh, face.z);
    const glm::dvec3 normal = glm::cross(glm::dvec3(b - a), glm::dvec3(c - a));
    const double length = glm::length(normal);
    char facet[kFacetBytes];
    char* at = append(facet, length > 0.0 ? glm::vec3(normal / length) : glm::vec3(0.0F));
    for (const glm::vec3& corner : {a, b, c}) at = append(at, corner);
    append(at, uint16_t{0});
    out.write(facet, kFacetBytes);
  }
}

}  // namespace raymap
