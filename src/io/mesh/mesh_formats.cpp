#include "io/mesh/mesh_formats.h"

#include <charconv>

namespace raymap {

Mesh rounded(const WritableMesh& mesh, Precision precision) {
  std::vector<glm::uvec3> triangles(mesh.triangles.begin(), mesh.triangles.end());
  const auto count = static_cast<uint32_t>(mesh.vertices.size());
  if (precision == Precision::Double) {
    std::vector<glm::dvec3> positions;
    positions.reserve(count);
    for (uint32_t v = 0; v < count; ++v) positions.push_back(mesh.exactPosition(v));
    return makeMesh(positions, std::move(triangles));
  }
  if (precision == Precision::Origin)
    return {{mesh.vertices.begin(), mesh.vertices.end()}, std::move(triangles), mesh.origin};
  std::vector<glm::vec3> positions;
  positions.reserve(count);
  for (uint32_t v = 0; v < count; ++v) positions.push_back(singlePosition(mesh, v));
  return {std::move(positions), std::move(triangles)};
}

glm::vec4 colourOf(const WritableMesh& mesh, uint32_t vertex) {
  const uint32_t id = mesh.colours.ids[vertex];
  return id == kNoAttribute ? glm::vec4(1.0F) : mesh.attributes->colours.values[id];
}

std::string offsetNote(const glm::dvec3& offset) {
  if (offset == glm::dvec3(0.0)) return {};
  std::string note = "offset";
  for (int axis = 0; axis < 3; ++axis) {
    char digits[32];
    note.append(" ").append(digits, std::to_chars(digits, digits + sizeof(digits), offset[axis]).ptr);
  }
  return note;
}

}  // namespace raymap
