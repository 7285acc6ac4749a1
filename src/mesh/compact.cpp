#include "mesh/compact.h"

#include "mesh/model.h"

namespace raymap {

namespace {

constexpr uint32_t kNoNumber = UINT32_MAX;

}  // namespace

void removeUnusedVertices(Mesh& mesh) {
  std::vector<uint32_t> numbers(mesh.vertices.size(), kNoNumber);
  for (const glm::uvec3& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) numbers[t[c]] = 0;
  uint32_t next = 0;
  for (uint32_t v = 0; v < numbers.size(); ++v) {
    if (numbers[v] == kNoNumber) continue;
    mesh.vertices[next] = mesh.vertices[v];
    numbers[v] = next++;
  }
  mesh.vertices.resize(next);
  for (glm::uvec3& t : mesh.triangles) t = {numbers[t.x], numbers[t.y], numbers[t.z]};
}

Mesh weldedCopy(const Model& mesh) {
  std::vector<uint32_t> firsts;
  return weldedCopy(mesh, mesh.welding(), firsts);
}

Mesh weldedCopy(const PackedMesh& mesh, const Welding& welding, std::vector<uint32_t>& firsts) {
  std::vector<uint32_t> numbers(welding.count, kNoNumber);
  Mesh result{.triangles = {mesh.triangles.begin(), mesh.triangles.end()}, .origin = mesh.origin};
  result.vertices.reserve(welding.count);
  for (uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    uint32_t& number = numbers[welding.ids[v]];
    if (number != kNoNumber) continue;
    number = uint32_t(result.vertices.size());
    result.vertices.push_back(mesh.vertices[v]);
    firsts.push_back(v);
  }
  for (glm::uvec3& t : result.triangles)
    for (int c = 0; c < 3; ++c) t[c] = numbers[welding.ids[t[c]]];
  return result;
}

}  // namespace raymap
