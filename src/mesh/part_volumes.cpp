#include "mesh/part_volumes.h"

#include "mesh/triangle.h"

namespace raymap {

std::vector<double> partVolumes(const PackedMesh& mesh, std::span<const uint32_t> partOfFace, size_t parts) {
  constexpr uint32_t kNone = UINT32_MAX;
  std::vector<double> volumes(parts);
  std::vector<uint32_t> firsts(parts, kNone);
  for (size_t f = 0; f < partOfFace.size(); ++f) {
    const glm::uvec3& face = mesh.triangles[f];
    uint32_t& first = firsts[partOfFace[f]];
    if (first == kNone) first = face.x;
    const glm::dvec3 centre(mesh.vertices[first]);
    const auto [a, b, c] = mesh.corners(face);
    volumes[partOfFace[f]] += signedVolume(a - centre, b - centre, c - centre);
  }
  return volumes;
}

}  // namespace raymap
