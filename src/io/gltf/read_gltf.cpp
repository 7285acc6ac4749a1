// glTF 2.0 and GLB: the default scene with its transforms and instances. Skins and morphs stay at rest.

#include "io/gltf/gltf_scene.h"
#include "io/mesh/mesh_file.h"

namespace raymap {

Mesh readGltf(const MeshFile& file) {
  GltfScene scene(file);
  scene.checkSize(sizeof(glm::dvec3));
  const std::vector<glm::dmat4> transforms = scene.worldTransforms();
  std::vector<glm::dvec3> positions;
  std::vector<glm::uvec3> triangles;
  for (size_t n = 0; n < transforms.size(); ++n) {
    const size_t firstTriangle = triangles.size();
    for (const GltfScene::Json* surface : scene.surfaces(*scene.nodes()[n].json)) {
      const std::vector<glm::dvec3> local = scene.positions(*surface);
      const auto first = static_cast<uint32_t>(positions.size());
      if (positions.size() + local.size() >= UINT32_MAX) file.fail("more than 2^32 vertices");
      for (const glm::dvec3& p : local) positions.emplace_back(transforms[n] * glm::dvec4(p, 1.0));
      for (const glm::uvec3& triangle : scene.triangles(*surface, local.size()))
        triangles.push_back(triangle + first);
    }
    if (glm::determinant(glm::dmat3(transforms[n])) < 0.0)
      turnOver(std::span(triangles).subspan(firstTriangle));
  }
  scene.warnOfOthers();
  return finishMesh(file, std::move(positions), std::move(triangles));
}

}  // namespace raymap
