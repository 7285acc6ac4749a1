#include "io/gltf/gltf_scene.h"

#include <raymap/error.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/text.h"
#include "io/gltf/gltf_extensions.h"

namespace raymap {

namespace {

// Primitive modes, numbered as in the file.
constexpr uint64_t kTriangles = 4, kStrip = 5, kFan = 6;

/// Returns whether a primitive has positions. Without them it is ignored.
bool hasPositions(const GltfScene::Json& primitive) {
  const auto attributes = primitive.find("attributes");
  return attributes != primitive.end() && attributes->contains("POSITION");
}

bool hasTriangles(const GltfDocument& document, const GltfScene::Json& primitive) {
  const uint64_t mode = document.number(primitive, "mode", kTriangles);
  return mode == kTriangles || mode == kStrip || mode == kFan;
}

bool isHidden(const GltfScene::Json& node) {
  const GltfScene::Json* visibility = extensionOf(node, "KHR_node_visibility");
  return visibility && visibility->contains("visible") && (*visibility)["visible"] == false;
}

}  // namespace

GltfScene::GltfScene(const MeshFile& file) : file_(file), document_(file) {
  checkExtensions();
  findNodes();
}

void GltfScene::checkExtensions() const {
  const auto required = document_.root().find("extensionsRequired");
  if (required == document_.root().end() || !required->is_array()) return;
  for (const Json& name : *required)
    if (name.is_string() && !isReadableExtension(name.get_ref<const std::string&>()))
      throw Error(ErrorCode::Unsupported,
                  file_.path.string() + ": it requires the glTF extension " +
                      shortText(name.get_ref<const std::string&>(), kLongestName) +
                      ", which is unknown here and may change its shape; export it without that");
}

std::vector<uint64_t> GltfScene::rootNodes() const {
  const uint64_t scenes = document_.size("scenes");
  const bool hasDefault = document_.root().contains("scene");
  if (!hasDefault && scenes > 1)
    file_.warnThat("it has " + counted(scenes, "scene") +
                   " and names none as its default: the first is read");
  if (hasDefault || scenes > 0)
    return document_.indices(document_.element("scenes", document_.number(document_.root(), "scene", 0)),
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
    const bool isVisible =
        !isHidden(node) && (visit.parent < 0 || nodes_[static_cast<size_t>(visit.parent)].isVisible);
    nodes_.push_back({visit.node, visit.parent, &node, isVisible});
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

glm::dmat4 GltfScene::Placement::matrix() const {
  const glm::dmat4 turned =
      glm::translate(glm::dmat4(1.0), translation) * glm::mat4_cast(glm::normalize(rotation));
  return glm::scale(turned, scale);
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

GltfScene::Surfaces GltfScene::readSurfaces(uint64_t mesh) const {
  Surfaces result;
  const Json& json = document_.element("meshes", mesh);
  const auto list = json.find("primitives");
  if (list == json.end() || !list->is_array())
    file_.fail("meshes[" + std::to_string(mesh) + "] has no list of primitives");
  for (const Json& primitive : *list) {
    if (!primitive.is_object()) file_.fail("a primitive is not an object");
    if (!hasTriangles(document_, primitive)) {
      ++result.others;
    } else if (hasPositions(primitive)) {
      result.list.push_back(&primitive);
      const uint64_t vertices =
          document_.accessorCount(document_.number(primitive["attributes"], "POSITION"));
      result.vertices += vertices;
      result.corners += primitive.contains("indices")
                            ? document_.accessorCount(document_.number(primitive, "indices"))
                            : vertices;
    }
  }
  return result;
}

const GltfScene::Surfaces& GltfScene::surfaces(const Node& node) const {
  static const Surfaces kNone;
  if (!node.isVisible || !node.json->contains("mesh")) return kNone;
  const uint64_t mesh = document_.number(*node.json, "mesh");
  const auto found = surfaces_.find(mesh);
  return found != surfaces_.end() ? found->second : surfaces_.emplace(mesh, readSurfaces(mesh)).first->second;
}

std::vector<double> GltfScene::attribute(const Json& surface, const std::string& name, const char* type,
                                         uint64_t components, std::optional<size_t> vertices) const {
  const uint64_t accessor = document_.number(surface["attributes"], name.c_str());
  const auto compressed = draco_.find(&surface);
  std::vector<double> numbers;
  if (compressed == draco_.end() || !compressed->second.attributes.contains(name)) {
    numbers = document_.reals(accessor, type, components);
  } else {
    const DracoSurface::Attribute& attribute = compressed->second.attributes.at(name);
    if (attribute.components != components)
      file_.fail("its Draco data have " + std::to_string(attribute.components) + " numbers for each " + name +
                 "; glTF wants " + std::to_string(components));
    for (const double number : attribute.numbers) numbers.push_back(document_.real(accessor, number));
  }
  if (vertices && numbers.size() != components * *vertices)
    file_.fail("accessors[" + std::to_string(accessor) + "]: " + name + " of " +
               counted(numbers.size() / components, "vertex") + ", POSITION has " +
               std::to_string(*vertices));
  return numbers;
}

std::vector<glm::dvec3> GltfScene::positions(const Json& surface) const {
  return vectors(attribute(surface, "POSITION", "VEC3", 3));
}

const GltfScene::Json* GltfScene::instanceAttributes(const Node& node) const {
  const Json* instancing = node.isVisible ? extensionOf(*node.json, "EXT_mesh_gpu_instancing") : nullptr;
  if (!instancing || !node.json->contains("mesh")) return nullptr;
  const auto attributes = instancing->find("attributes");
  const bool hasAny = attributes != instancing->end() && attributes->is_object() && !attributes->empty();
  return hasAny ? &*attributes : nullptr;
}

uint64_t GltfScene::instanceCount(const Node& node) const {
  const Json* attributes = instanceAttributes(node);
  if (!attributes) return 1;
  std::optional<uint64_t> count;
  for (const auto& [name, accessor] : attributes->items()) {
    const uint64_t each = document_.accessorCount(document_.number(*attributes, name.c_str()));
    if (count.value_or(each) != each)
      file_.fail("nodes[" + std::to_string(node.index) + "]: its instances have " + std::to_string(*count) +
                 " and " + counted(each, "value") + "; all their accessors must have the same count");
    count = each;
  }
  return count.value_or(1);
}

std::optional<std::vector<GltfScene::Placement>> GltfScene::instances(const Node& node) const {
  const Json* attributes = instanceAttributes(node);
  if (!attributes) return std::nullopt;
  std::vector<Placement> places(instanceCount(node));
  const auto read = [&](const char* name, const char* type, uint64_t components) {
    return attributes->contains(name) ? document_.reals(document_.number(*attributes, name), type, components)
                                      : std::vector<double>();
  };
  const std::vector<double> t = read("TRANSLATION", "VEC3", 3), r = read("ROTATION", "VEC4", 4),
                            s = read("SCALE", "VEC3", 3);
  for (size_t i = 0; i < places.size(); ++i) {
    if (!t.empty()) places[i].translation = {t[3 * i], t[3 * i + 1], t[3 * i + 2]};
    if (!r.empty()) places[i].rotation = {r[4 * i + 3], r[4 * i], r[4 * i + 1], r[4 * i + 2]};
    if (!s.empty()) places[i].scale = {s[3 * i], s[3 * i + 1], s[3 * i + 2]};
  }
  return places;
}

bool GltfScene::hasRealPositions(const Json& surface) const {
  constexpr uint64_t kFloat = 5126;  // Numbered as in the file.
  const uint64_t accessor = document_.number(surface["attributes"], "POSITION");
  return document_.number(document_.element("accessors", accessor), "componentType") == kFloat;
}

void GltfScene::open(size_t bytesPerVertex) {
  checkSize(bytesPerVertex);
  std::vector<const Json*> compressed;
  for (const auto& [mesh, surfaces] : surfaces_)
    for (const Json* surface : surfaces.list)
      if (needsDraco(document_, *surface)) compressed.push_back(surface);
  draco_ = decodeDraco(file_, document_, compressed);
}

void GltfScene::checkSize(size_t bytesPerVertex) const {
  constexpr uint64_t kMost = UINT64_MAX / 4;
  uint64_t bytes = 0;
  for (const Node& node : nodes_) {
    const Surfaces& all = surfaces(node);
    const uint64_t count = instanceCount(node);
    const uint64_t each = all.vertices * bytesPerVertex + all.corners * sizeof(glm::uvec3) +
                          (all.list.size() + 1) * kBytesPerInstance;
    bytes += count > kMost / each ? kMost : count * each;
    checkExpansion(file_, bytes, document_.bytes());
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
  if (const auto compressed = draco_.find(&surface); compressed != draco_.end()) {
    for (const glm::uvec3& triangle : compressed->second.triangles)
      if (std::max({triangle.x, triangle.y, triangle.z}) >= vertexCount)
        file_.fail("its Draco data are damaged: a triangle has a vertex that they lack");
    return compressed->second.triangles;
  }
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
  uint64_t others = 0, hidden = 0;
  for (const Node& node : nodes_) {
    others += surfaces(node).others;
    hidden += !node.isVisible && node.json->contains("mesh") ? 1 : 0;
  }
  if (others > 0) file_.warnThat(counted(others, "primitive") + " of points or lines ignored");
  if (hidden > 0) file_.warnThat(counted(hidden, "node") + " with a mesh left out, for the file hides them");
}

void turnOver(std::span<glm::uvec3> triangles) {
  for (glm::uvec3& triangle : triangles) std::swap(triangle.y, triangle.z);
}

}  // namespace raymap
