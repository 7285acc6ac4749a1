// glTF 2.0 and GLB: the default scene with its transforms and instances. Skins and morphs stay at rest.

#include <raymap/error.h>
#include <raymap/warning.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/text.h"
#include "io/gltf/gltf_scene.h"
#include "io/mesh/base_colour.h"
#include "io/mesh/mesh_file.h"
#include "mesh/attribute_words.h"

namespace raymap {

namespace {

/// Vertices and triangles of a mesh, in its own coordinates, and the attributes of triangles.
struct LocalMesh {
  std::vector<glm::dvec3> positions;
  std::vector<glm::uvec3> triangles, uvs, colours;
  std::vector<uint32_t> materials;
};

/// Returns a position of a node in the scene. A translation alone keeps every bit where it is 0.
glm::dvec3 inScene(const glm::dmat4& transform, const glm::dvec3& p) {
  if (glm::dmat3(transform) != glm::dmat3(1.0)) return transform * glm::dvec4(p, 1.0);
  const glm::dvec3 by(transform[3]);
  return {by.x == 0.0 ? p.x : p.x + by.x, by.y == 0.0 ? p.y : p.y + by.y, by.z == 0.0 ? p.z : p.z + by.z};
}

std::string nameOf(const GltfScene::Json& json) {
  const auto name = json.find("name");
  return name != json.end() && name->is_string() ? name->get<std::string>() : std::string();
}

constexpr const char *kUvs = "texture coordinates", *kColours = "colours", *kMaterials = "materials";

/// Reads the attributes of a scene. Those of a kind are left out, with a warning, if any of them is
/// malformed.
class AttributeReader {
 public:
  using Json = GltfScene::Json;

  AttributeReader(const MeshFile& file, const GltfScene& scene)
      : file_(file), scene_(scene), found_(*file.attributes) {}

  /// Adds the attributes of a surface with these vertices and triangles to those of its mesh.
  void read(const Json& surface, size_t vertices, std::span<const glm::uvec3> triangles, LocalMesh& mesh) {
    readCorners(surface, "TEXCOORD_0", kUvs, vertices, triangles, found_.uvs.values, mesh.uvs);
    readCorners(surface, "COLOR_0", kColours, vertices, triangles, found_.colours.values, mesh.colours);
    if (surface["attributes"].contains("TEXCOORD_1")) lose("further texture coordinates");
    if (surface["attributes"].contains("COLOR_1")) lose("further colours");
    if (extensionOf(surface, "KHR_materials_variants")) lose("variants of materials");
    uint32_t material = kNoAttribute;
    const auto readMaterial = [&] {
      document_.element("materials", document_.number(surface, "material"));
      material = uint32_t(document_.number(surface, "material"));
    };
    if (surface.contains("material")) attempt(kMaterials, readMaterial);
    mesh.materials.resize(mesh.uvs.size(), material);
  }

  void append(const LocalMesh& mesh, bool isMirrored) {
    const auto add = [&](const auto& from, auto& to) {
      to.insert(to.end(), from.begin(), from.end());
      if constexpr (requires { turnOver(to); })
        if (isMirrored) turnOver(std::span(to).last(from.size()));
    };
    add(mesh.materials, found_.materialOf);
    add(mesh.uvs, found_.uvs.corners);
    add(mesh.colours, found_.colours.corners);
  }

  /// Gives the triangles that have none yet the name of a node, or else of its mesh.
  void addPart(const GltfScene::Node& node, size_t triangles) {
    std::string name = nameOf(*node.json);
    if (name.empty()) name = nameOf(document_.element("meshes", document_.number(*node.json, "mesh")));
    found_.partOf.resize(triangles, name.empty() ? kNoAttribute : uint32_t(found_.parts.size()));
    found_.parts.push_back({std::move(name)});
  }

  /// Reads the materials. Drops what no triangle has.
  void finish() {
    const auto isNone = [](const auto& at) { return at == std::remove_cvref_t<decltype(at)>(kNoAttribute); };
    if (isLost(kUvs) || std::ranges::all_of(found_.uvs.corners, isNone)) found_.uvs = {};
    for (glm::vec4& colour : found_.colours.values) colour = encodedColour(colour);
    if (isLost(kColours) || std::ranges::all_of(found_.colours.corners, isNone)) found_.colours = {};
    if (isLost(kMaterials) || std::ranges::all_of(found_.materialOf, isNone))
      return found_.materialOf.clear();
    for (const Json& material : document_.root()["materials"]) {
      const std::string name = nameOf(material);
      found_.materials.push_back(name.empty() ? "material " + std::to_string(found_.materials.size()) : name);
    }
    attempt("looks of materials", [&] { found_.gltf = readMaterials(file_, document_, found_.lost); });
  }

 private:
  bool isLost(const std::string& kind) const { return std::ranges::count(found_.lost, kind) > 0; }
  void lose(const char* kind) {
    if (!isLost(kind)) found_.lost.emplace_back(kind);
  }

  /// Reads attributes of a kind, unless some were malformed. Returns false, and warns, if these are.
  template <class Read>
  bool attempt(const char* kind, Read read) {
    if (isLost(kind)) return false;
    try {
      read();
      return true;
    } catch (const Error& error) {
      if (error.code() == ErrorCode::Memory) throw;
      const std::string what = std::string(error.what()) + "; its " + kind + " are left out";
      if (file_.warn) file_.warn({WarningCode::FileContent, what, {.file = file_.path.string()}});
      lose(kind);
      return false;
    }
  }

  template <class Value>
  void readCorners(const Json& surface, const char* name, const char* kind, size_t vertices,
                   std::span<const glm::uvec3> triangles, std::vector<Value>& values,
                   std::vector<glm::uvec3>& corners) {
    const auto first = uint32_t(values.size());
    const auto readValues = [&] {
      const Json& accessor = document_.element("accessors", document_.number(surface["attributes"], name));
      constexpr size_t kMost = Value::length();
      const size_t count = kMost == 4 && accessor.value("type", Json()) == "VEC3" ? 3 : kMost;
      const std::string type = "VEC" + std::to_string(count);
      const std::vector<double> numbers = scene_.attribute(surface, name, type.c_str(), count, vertices);
      for (size_t i = 0; i < numbers.size(); ++i) {
        if (!std::isfinite(numbers[i])) file_.fail(std::string(name) + " holds " + numberText(numbers[i]));
        if (i % count == 0) values.emplace_back(1.0F);
        const bool isFromTop = kMost == 2 && i % count == 1;
        values.back()[int(i % count)] = float(isFromTop ? 1.0 - numbers[i] : numbers[i]);
      }
    };
    const bool isRead = surface["attributes"].contains(name) && attempt(kind, readValues);
    for (const glm::uvec3& t : triangles) corners.push_back(isRead ? t + first : glm::uvec3(kNoAttribute));
  }

  const MeshFile& file_;
  const GltfScene& scene_;
  const GltfDocument& document_ = scene_.document();
  MeshAttributes& found_;
};

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
    if (file_.attributes) attributes_.emplace(file_, scene_);
    for (const GltfScene::Node& node : scene_.nodes()) ++uses_[&scene_.surfaces(node)];
    for (size_t n = 0; n < transforms.size(); ++n) {
      const GltfScene::Node& node = scene_.nodes()[n];
      const GltfScene::Surfaces& surfaces = scene_.surfaces(node);
      if (surfaces.list.empty()) continue;
      // A mesh is read once, and kept as long as nodes need it.
      auto [mesh, isNew] = meshes_.try_emplace(&surfaces);
      if (isNew) mesh->second = readLocal(surfaces);
      if (const auto places = scene_.instances(node)) {
        for (const GltfScene::Placement& place : *places)
          append(mesh->second, transforms[n] * place.matrix());
      } else {
        append(mesh->second, transforms[n]);
      }
      if (--uses_[&surfaces] == 0) meshes_.erase(mesh);
      if (attributes_) attributes_->addPart(node, triangles_.size());
    }
    if (attributes_) attributes_->finish();
    scene_.warnOfOthers();
    return finishMesh(file_, std::move(positions_), std::move(triangles_), &origin_);
  }

 private:
  LocalMesh readLocal(const GltfScene::Surfaces& surfaces) {
    LocalMesh mesh;
    for (const GltfScene::Json* surface : surfaces.list) {
      const std::vector<glm::dvec3> positions = scene_.positions(*surface);
      const auto first = static_cast<uint32_t>(mesh.positions.size());
      mesh.positions.insert(mesh.positions.end(), positions.begin(), positions.end());
      const std::vector<glm::uvec3> triangles = scene_.triangles(*surface, positions.size());
      for (const glm::uvec3& triangle : triangles) mesh.triangles.push_back(triangle + first);
      if (attributes_) attributes_->read(*surface, positions.size(), triangles, mesh);
    }
    return mesh;
  }

  void append(const LocalMesh& mesh, const glm::dmat4& transform) {
    const auto first = static_cast<uint32_t>(positions_.size());
    if (positions_.size() + mesh.positions.size() >= UINT32_MAX) file_.fail("more than 2^32 vertices");
    for (const glm::dvec3& p : mesh.positions) positions_.push_back(inScene(transform, p));
    origin_ = transform[3];
    const size_t firstTriangle = triangles_.size();
    for (const glm::uvec3& triangle : mesh.triangles) triangles_.push_back(triangle + first);
    const bool isMirrored = glm::determinant(glm::dmat3(transform)) < 0.0;
    if (isMirrored) turnOver(std::span(triangles_).subspan(firstTriangle));
    if (attributes_) attributes_->append(mesh, isMirrored);
  }

  const MeshFile& file_;
  GltfScene scene_;
  std::optional<AttributeReader> attributes_;
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
  if (file.attributes) file.attributes->lost.emplace_back("attributes of its skin of whole numbers");
  return readStandingGltf(file);
}

}  // namespace raymap
