#include "io/gltf/gltf_scene.h"

#include <raymap/error.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

namespace raymap {

namespace {

// Primitive modes, numbered as in the file.
constexpr uint64_t kTriangles = 4, kStrip = 5, kFan = 6;

/// Returns whether a primitive has positions. Without them it is ignored.
bool hasPositions(const GltfScene::Json& primitive) {
  const auto attributes = primitive.find("attributes");
  return attributes != primitive.end() && attributes->contains("POSITION");
}

}  // namespace

GltfScene::GltfScene(const MeshFile& file) : file_(file), document_(file) {
  checkExtensions();
  findNodes();
}

void GltfScene::checkExtensions() const {
  const auto required = document_.root().find("extensionsRequired");
  if (required == document_.root().end() || !required->is_array()) return;
  for (const Json& name : *required) {
    if (!name.is_string()) continue;
    const auto& extension = name.get_ref<const std::string&>();
    if (extension == "KHR_draco_mesh_compression" || extension == "EXT_meshopt_compression" ||
        extension == "EXT_mesh_gpu_instancing")
      throw Error(ErrorCode::Unsupported, file_.path.string() + ": it needs the glTF extension " + extension +
                                              "; export it without that");
  }
}

std::vector<uint64_t> GltfScene::rootNodes() const {
  if (document_.root().contains("scene"))
    return document_.indices(document_.element("scenes", document_.number(document_.root(), "scene")),
                             "nodes");
  const uint64_t count = document_.size("nodes");
  std::vector<bool> isChild(count);
  for (uint64_t n = 0; n < count; ++n)
    for (const uint64_t child : document_.indices(document_.element("nodes", n), "children"))
      if (child < count) isChild[child] = true;
  std::vector<uint64_t> roots;
  for (uint64_t n = 0; n < count; ++n)
    if (!isChild[n]) roots.push_back(n);
  if (roots.empty() && count > 0) file_.fail("every node is another node's child: the nodes form a cycle");
  return roots;
}

/// Lists the nodes of the scene. Fails if one is reached twice, because nodes must form trees; a cycle would
/// never end.
void GltfScene::findNodes() {
  struct Visit {
    uint64_t node;
    int parent;
  };
  std::vector<Visit> stack;
  for (const uint64_t root : rootNodes()) stack.push_back({root, -1});
  std::reverse(stack.begin(), stack.end());
  std::vector<bool> seen(document_.size("nodes"));
  while (!stack.empty()) {
    const Visit visit = stack.back();
    stack.pop_back();
    const Json& node = document_.element("nodes", visit.node);
    if (seen[visit.node])
      file_.fail("nodes[" + std::to_string(visit.node) + "] is reached twice: the nodes do not form a tree");
    seen[visit.node] = true;
    for (const uint64_t child : document_.indices(node, "children"))
      stack.push_back({child, static_cast<int>(nodes_.size())});
    nodes_.push_back({visit.node, visit.parent, &node});
  }
}

std::vector<double> GltfScene::numbers(const Node& node, const char* key, size_t count) const {
  return document_.numbers(*node.json, "nodes[" + std::to_string(node.index) + "]", key, count);
}

glm::dmat4 GltfScene::transform(const Node& node) const {
  const std::vector<double> matrix = numbers(node, "matrix", 16);
  glm::dmat4 result(1.0);
  if (!matrix.empty()) {
    for (int i = 0; i < 16; ++i) result[i / 4][i % 4] = matrix[static_cast<size_t>(i)];
    return result;
  }
  const std::vector<double> t = numbers(node, "translation", 3);
  const std::vector<double> r = numbers(node, "rotation", 4);
  const std::vector<double> s = numbers(node, "scale", 3);
  if (!t.empty()) result = glm::translate(result, {t[0], t[1], t[2]});
  if (!r.empty()) result *= glm::mat4_cast(glm::normalize(glm::dquat(r[3], r[0], r[1], r[2])));
  if (!s.empty()) result = glm::scale(result, {s[0], s[1], s[2]});
  return result;
}

std::vector<glm::dmat4> GltfScene::worldTransforms() const {
  std::vector<glm::dmat4> result;
  result.reserve(nodes_.size());
  for (const Node& node : nodes_) {
    const glm::dmat4 local = transform(node);
    result.push_back(node.parent < 0 ? local : result[static_cast<size_t>(node.parent)] * local);
  }
  return result;
}

std::vector<const GltfScene::Json*> GltfScene::primitives(const Json& node) const {
  std::vector<const Json*> result;
  if (!node.contains("mesh")) return result;
  const uint64_t mesh = document_.number(node, "mesh");
  const Json& json = document_.element("meshes", mesh);
  const auto list = json.find("primitives");
  if (list == json.end() || !list->is_array())
    file_.fail("meshes[" + std::to_string(mesh) + "] has no list of primitives");
  for (const Json& primitive : *list) {
    if (!primitive.is_object()) file_.fail("a primitive is not an object");
    result.push_back(&primitive);
  }
  return result;
}

bool GltfScene::hasTriangles(const Json& primitive) const {
  const uint64_t mode = document_.number(primitive, "mode", kTriangles);
  return mode == kTriangles || mode == kStrip || mode == kFan;
}

std::vector<const GltfScene::Json*> GltfScene::surfaces(const Json& node) const {
  std::vector<const Json*> result = primitives(node);
  std::erase_if(result, [&](const Json* p) { return !hasTriangles(*p) || !hasPositions(*p); });
  return result;
}

std::vector<glm::dvec3> GltfScene::positions(const Json& surface) const {
  return document_.positions(document_.number(surface["attributes"], "POSITION"));
}

void GltfScene::checkSize(size_t bytesPerVertex) const {
  uint64_t bytes = 0;
  for (const Node& node : nodes_)
    for (const Json* surface : surfaces(*node.json)) {
      const uint64_t vertices =
          document_.accessorCount(document_.number((*surface)["attributes"], "POSITION"));
      const uint64_t corners = surface->contains("indices")
                                   ? document_.accessorCount(document_.number(*surface, "indices"))
                                   : vertices;
      bytes += vertices * bytesPerVertex + corners * sizeof(glm::uvec3);
      checkMemory(file_, bytes);
    }
}

std::vector<uint32_t> GltfScene::corners(const Json& surface, size_t vertexCount) const {
  std::vector<uint32_t> result;
  if (!surface.contains("indices")) {
    for (uint32_t v = 0; v < vertexCount; ++v) result.push_back(v);
    return result;
  }
  const uint64_t accessor = document_.number(surface, "indices");
  result = document_.vertexIndices(accessor);
  for (size_t i = 0; i < result.size(); ++i)
    if (result[i] >= vertexCount)
      file_.fail("accessors[" + std::to_string(accessor) + "]: index " + std::to_string(i) + ": vertex " +
                 std::to_string(result[i]) + " is out of range (it has " + counted(vertexCount, "vertex") +
                 ")");
  return result;
}

std::vector<glm::uvec3> GltfScene::triangles(const Json& surface, size_t vertexCount) const {
  const std::vector<uint32_t> all = corners(surface, vertexCount);
  const uint64_t mode = document_.number(surface, "mode", kTriangles);
  std::vector<glm::uvec3> result;
  if (mode == kStrip) appendStrip(all, result);
  if (mode == kFan) appendFan(all, result);
  if (mode == kTriangles) {
    for (size_t i = 0; i + 3 <= all.size(); i += 3) result.emplace_back(all[i], all[i + 1], all[i + 2]);
    if (all.size() % 3 != 0) file_.warnThat("a list of triangles ends within a triangle, which is dropped");
  }
  return result;
}

void GltfScene::warnOfOthers() const {
  uint64_t others = 0;
  for (const Node& node : nodes_)
    for (const Json* primitive : primitives(*node.json)) others += hasTriangles(*primitive) ? 0 : 1;
  if (others > 0) file_.warnThat(counted(others, "primitive") + " of points or lines ignored");
}

void turnOver(std::span<glm::uvec3> triangles) {
  for (glm::uvec3& triangle : triangles) std::swap(triangle.y, triangle.z);
}

}  // namespace raymap
