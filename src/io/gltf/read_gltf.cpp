// glTF 2.0 and GLB: the default scene with its transforms and instances. Skins and morphs stay at rest.

#include <algorithm>
#include <set>

#include "io/gltf/gltf_scene.h"
#include "io/mesh/mesh_file.h"
#include "mesh/attribute_words.h"

namespace raymap {

namespace {

/// Vertices and triangles of a mesh, in its own coordinates.
struct LocalMesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::uvec3> triangles;
};

LocalMesh readLocal(const GltfScene& scene, const GltfScene::Surfaces& surfaces) {
  LocalMesh mesh;
  for (const GltfScene::Json* surface : surfaces.list) {
    const std::vector<glm::dvec3> positions = scene.positions(*surface);
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), positions.begin(), positions.end());
    for (const glm::uvec3& triangle : scene.triangles(*surface, positions.size()))
      mesh.triangles.push_back(triangle + first);
  }
  return mesh;
}

/// Returns a position of a node in the scene. A translation alone keeps every bit where it is 0.
glm::dvec3 inScene(const glm::dmat4& transform, const glm::dvec3& p) {
  if (glm::dmat3(transform) != glm::dmat3(1.0)) return transform * glm::dvec4(p, 1.0);
  const glm::dvec3 by(transform[3]);
  return {by.x == 0.0 ? p.x : p.x + by.x, by.y == 0.0 ? p.y : p.y + by.y, by.z == 0.0 ? p.z : p.z + by.z};
}

class RestReader {
 public:
  explicit RestReader(const MeshFile& file) : file_(file), scene_(file) {}

  /// Returns whether a skin moves positions that are whole numbers: it may have their scale.
  bool hasQuantizedSkin() const {
    return std::ranges::any_of(scene_.nodes(), [&](const GltfScene::Node& node) {
      return node.json->contains("skin") &&
             std::ranges::any_of(scene_.surfaces(node).list, [&](const GltfScene::Json* surface) {
               return !scene_.hasRealPositions(*surface) && (*surface)["attributes"].contains("JOINTS_0");
             });
    });
  }

  Mesh read() {
    scene_.open(sizeof(glm::dvec3));
    const std::vector<glm::dmat4> transforms = scene_.worldTransforms();
    if (file_.attributes) noteUnread();
    for (const GltfScene::Node& node : scene_.nodes()) ++uses_[&scene_.surfaces(node)];
    for (size_t n = 0; n < transforms.size(); ++n) {
      const GltfScene::Node& node = scene_.nodes()[n];
      const GltfScene::Surfaces& surfaces = scene_.surfaces(node);
      if (surfaces.list.empty()) continue;
      // A mesh is read once, and kept as long as nodes need it.
      auto [mesh, isNew] = meshes_.try_emplace(&surfaces);
      if (isNew) mesh->second = readLocal(scene_, surfaces);
      if (const auto places = scene_.instances(node)) {
        for (const GltfScene::Placement& place : *places)
          append(mesh->second, transforms[n] * place.matrix());
      } else {
        append(mesh->second, transforms[n]);
      }
      if (--uses_[&surfaces] == 0) meshes_.erase(mesh);
      if (file_.attributes) addPart(node);
    }
    scene_.warnOfOthers();
    return finishMesh(file_, std::move(positions_), std::move(triangles_), &origin_);
  }

  /// Notes what the scene says beside the names of nodes.
  void noteUnread() const {
    std::set<uint64_t> materials;
    bool hasUvs = false, hasColours = false;
    for (const GltfScene::Node& node : scene_.nodes())
      for (const GltfScene::Json* surface : scene_.surfaces(node).list) {
        if (surface->contains("material")) materials.insert(scene_.document().number(*surface, "material"));
        hasUvs = hasUvs || (*surface)["attributes"].contains("TEXCOORD_0");
        hasColours = hasColours || (*surface)["attributes"].contains("COLOR_0");
      }
    std::vector<std::string>& lost = file_.attributes->lost;
    if (!materials.empty()) lost.push_back(counted(materials.size(), "material"));
    if (hasUvs) lost.emplace_back("texture coordinates");
    if (hasColours) lost.emplace_back("colours");
  }

 private:
  /// Gives the triangles that have none yet the name of a node, or else of its mesh.
  void addPart(const GltfScene::Node& node) {
    const GltfScene::Json& mesh =
        scene_.document().element("meshes", scene_.document().number(*node.json, "mesh"));
    const auto nameOf = [](const GltfScene::Json& json) {
      const auto name = json.find("name");
      return name != json.end() && name->is_string() ? name->get<std::string>() : std::string();
    };
    std::string name = nameOf(*node.json);
    if (name.empty()) name = nameOf(mesh);
    MeshAttributes& found = *file_.attributes;
    found.partOf.resize(triangles_.size(), name.empty() ? kNoAttribute : uint32_t(found.parts.size()));
    found.parts.push_back({std::move(name)});
  }

  void append(const LocalMesh& mesh, const glm::dmat4& transform) {
    const auto first = static_cast<uint32_t>(positions_.size());
    if (positions_.size() + mesh.positions.size() >= UINT32_MAX) file_.fail("more than 2^32 vertices");
    for (const glm::dvec3& p : mesh.positions) positions_.push_back(inScene(transform, p));
    origin_ = transform[3];
    const size_t firstTriangle = triangles_.size();
    for (const glm::uvec3& triangle : mesh.triangles) triangles_.push_back(triangle + first);
    if (glm::determinant(glm::dmat3(transform)) < 0.0) turnOver(std::span(triangles_).subspan(firstTriangle));
  }

  const MeshFile& file_;
  GltfScene scene_;
  std::map<const GltfScene::Surfaces*, size_t> uses_;  ///< Numbers of nodes that are still to be read.
  std::map<const GltfScene::Surfaces*, LocalMesh> meshes_;
  std::vector<glm::dvec3> positions_;
  std::vector<glm::uvec3> triangles_;
  glm::dvec3 origin_{0.0};  ///< Position of the last node. It keeps the floats of a single node exactly.
};

}  // namespace

Mesh readGltf(const MeshFile& file) {
  RestReader reader(file);
  if (!reader.hasQuantizedSkin()) return reader.read();
  if (file.attributes) reader.noteUnread();
  return readStandingGltf(file);
}

}  // namespace raymap
