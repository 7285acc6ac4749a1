// glTF 2.0 and GLB: the default scene with its transforms and instances; skins and morphs at rest.

#include <raymap/error.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "gltf_document.h"
#include "mesh_file.h"

namespace raymap {

namespace {

using Json = GltfDocument::Json;

struct Instance {
  uint64_t mesh = 0;
  glm::dmat4 transform{1.0};
};

// Primitive modes by their numbers in the file.
constexpr uint64_t kTriangles = 4, kStrip = 5, kFan = 6;

glm::dmat4 localTransform(const GltfDocument& document, const Json& node) {
  const std::vector<double> matrix = document.numbers(node, "matrix", 16);
  glm::dmat4 result(1.0);
  if (!matrix.empty()) {
    for (int i = 0; i < 16; ++i) result[i / 4][i % 4] = matrix[static_cast<size_t>(i)];
    return result;
  }
  const std::vector<double> t = document.numbers(node, "translation", 3);
  const std::vector<double> r = document.numbers(node, "rotation", 4);
  const std::vector<double> s = document.numbers(node, "scale", 3);
  if (!t.empty()) result = glm::translate(result, {t[0], t[1], t[2]});
  if (!r.empty()) result *= glm::mat4_cast(glm::normalize(glm::dquat(r[3], r[0], r[1], r[2])));
  if (!s.empty()) result = glm::scale(result, {s[0], s[1], s[2]});
  return result;
}

class GltfReader {
 public:
  explicit GltfReader(const MeshFile& file) : file_(file), document_(file) {}

  Mesh read() {
    checkExtensions();
    const std::vector<Instance> instances = findInstances();
    checkSize(instances);
    for (const Instance& instance : instances)
      for (const Json& primitive : primitives(instance.mesh)) readPrimitive(primitive, instance);
    if (otherModes_ > 0) file_.warnThat(counted(otherModes_, "primitive") + " of points or lines ignored");
    return finishMesh(file_, std::move(positions_), std::move(triangles_));
  }

 private:
  void checkExtensions() const {
    const auto required = document_.root().find("extensionsRequired");
    if (required == document_.root().end() || !required->is_array()) return;
    for (const Json& name : *required) {
      if (!name.is_string()) continue;
      const auto& extension = name.get_ref<const std::string&>();
      if (extension == "KHR_draco_mesh_compression" || extension == "EXT_meshopt_compression" ||
          extension == "EXT_mesh_gpu_instancing")
        throw Error(ErrorCode::Unsupported, file_.path.string() + ": it needs the glTF extension " +
                                                extension + "; export it without that");
    }
  }

  std::vector<uint64_t> rootNodes() const {
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

  /// Nodes must form trees; one that is reached twice would make a cycle or grow without bound.
  std::vector<Instance> findInstances() const {
    struct Visit {
      uint64_t node;
      glm::dmat4 parent;
    };
    std::vector<Visit> stack;
    for (const uint64_t root : rootNodes()) stack.push_back({root, glm::dmat4(1.0)});
    std::reverse(stack.begin(), stack.end());
    std::vector<bool> seen(document_.size("nodes"));
    std::vector<Instance> instances;
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const Json& node = document_.element("nodes", visit.node);
      if (seen[visit.node])
        file_.fail("nodes[" + std::to_string(visit.node) +
                   "] is reached twice: the nodes form a cycle, or no tree");
      seen[visit.node] = true;
      const glm::dmat4 transform = visit.parent * localTransform(document_, node);
      if (node.contains("mesh")) instances.push_back({document_.number(node, "mesh"), transform});
      for (const uint64_t child : document_.indices(node, "children")) stack.push_back({child, transform});
    }
    return instances;
  }

  const Json& primitives(uint64_t mesh) const {
    const Json& json = document_.element("meshes", mesh);
    const auto found = json.find("primitives");
    if (found == json.end() || !found->is_array())
      file_.fail("meshes[" + std::to_string(mesh) + "] has no list of primitives");
    return *found;
  }

  /// The accessor of the positions; nothing for a primitive without any.
  std::optional<uint64_t> positionAccessor(const Json& primitive) const {
    if (!primitive.is_object()) file_.fail("a primitive is no object");
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->contains("POSITION")) return std::nullopt;
    return document_.number(*attributes, "POSITION");
  }

  /// Instances let a small file ask for any amount of memory.
  void checkSize(const std::vector<Instance>& instances) const {
    uint64_t bytes = 0;
    for (const Instance& instance : instances)
      for (const Json& primitive : primitives(instance.mesh)) {
        const std::optional<uint64_t> positions = positionAccessor(primitive);
        if (!positions) continue;
        const uint64_t vertices = document_.accessorCount(*positions);
        const uint64_t corners = primitive.contains("indices")
                                     ? document_.accessorCount(document_.number(primitive, "indices"))
                                     : vertices;
        bytes += vertices * sizeof(glm::dvec3) + corners * sizeof(glm::uvec3);
        checkMemory(file_, bytes);
      }
  }

  void readPrimitive(const Json& primitive, const Instance& instance) {
    const std::optional<uint64_t> accessor = positionAccessor(primitive);
    const uint64_t mode = document_.number(primitive, "mode", kTriangles);
    if (mode != kTriangles && mode != kStrip && mode != kFan) ++otherModes_;
    if (!accessor || (mode != kTriangles && mode != kStrip && mode != kFan)) return;

    const std::vector<glm::dvec3> local = document_.positions(*accessor);
    const auto first = static_cast<uint32_t>(positions_.size());
    if (positions_.size() + local.size() >= UINT32_MAX) file_.fail("more than 2^32 vertices");
    for (const glm::dvec3& p : local) positions_.emplace_back(instance.transform * glm::dvec4(p, 1.0));

    const size_t firstTriangle = triangles_.size();
    appendTriangles(corners(primitive, instance.mesh, first, local.size()), mode);
    // A mirrored instance would be inside out.
    if (glm::determinant(glm::dmat3(instance.transform)) < 0.0)
      for (size_t t = firstTriangle; t < triangles_.size(); ++t) std::swap(triangles_[t].y, triangles_[t].z);
  }

  std::vector<uint32_t> corners(const Json& primitive, uint64_t mesh, uint32_t first,
                                size_t vertexCount) const {
    std::vector<uint32_t> result;
    if (primitive.contains("indices")) {
      result = document_.vertexIndices(document_.number(primitive, "indices"));
    } else {
      for (uint32_t v = 0; v < vertexCount; ++v) result.push_back(v);
    }
    for (size_t i = 0; i < result.size(); ++i) {
      if (result[i] >= vertexCount)
        file_.fail("meshes[" + std::to_string(mesh) + "]: index " + std::to_string(i) +
                   " of a primitive: vertex " + std::to_string(result[i]) + " is out of range (it has " +
                   counted(vertexCount, "vertex") + ")");
      result[i] += first;
    }
    return result;
  }

  void appendTriangles(const std::vector<uint32_t>& corners, uint64_t mode) {
    if (mode == kStrip) return appendStrip(corners, triangles_);
    if (mode == kFan) return appendFan(corners, triangles_);
    for (size_t i = 0; i + 3 <= corners.size(); i += 3)
      triangles_.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
    if (corners.size() % 3 != 0)
      file_.warnThat("a list of triangles ends within a triangle, which is dropped");
  }

  const MeshFile& file_;
  GltfDocument document_;
  std::vector<glm::dvec3> positions_;
  std::vector<glm::uvec3> triangles_;
  uint64_t otherModes_ = 0;
};

}  // namespace

Mesh readGltf(const MeshFile& file) {
  return GltfReader(file).read();
}

}  // namespace raymap
