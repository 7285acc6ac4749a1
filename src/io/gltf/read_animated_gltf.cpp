// glTF 2.0, §3.7.2.2 and §3.7.3: morph targets and skins. Each node that shows a mesh without a skin becomes
// a joint, so all movement comes from joints.

#include <raymap/error.h>
#include <raymap/mesh_view.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text.h"
#include "io/gltf/gltf_animation.h"
#include "io/gltf/gltf_scene.h"

namespace raymap {

namespace {

using Json = GltfDocument::Json;

/// Returns whether a matrix flattens space, as far as single precision tells.
bool isSingular(const glm::dmat4& matrix) {
  const glm::dmat3 turn(matrix);
  const double most = glm::length(turn[0]) * glm::length(turn[1]) * glm::length(turn[2]);
  return !(std::abs(glm::determinant(turn)) > 1e-6 * most);
}

class AnimatedReader {
 public:
  explicit AnimatedReader(const MeshFile& file) : file_(file), scene_(file), document_(scene_.document()) {
    places_.assign(document_.size("nodes"), -1);
    for (size_t n = 0; n < scene_.nodes().size(); ++n) places_[scene_.nodes()[n].index] = static_cast<int>(n);
  }

  AnimatedMesh read(const std::string& clip) {
    const uint64_t animation = animationNamed(file_, document_, clip);
    AnimatedMesh mesh = read(animation);
    if (mesh.tracks.empty())
      file_.fail("animations[" + std::to_string(animation) +
                 "] moves nothing that the scene shows; choose another, or read the mesh at rest");
    return mesh;
  }

  AnimatedMesh read(uint64_t animation) {
    const std::vector<IndexRange> morphs = readScene();
    mesh_.clips = animationNames(document_);
    mesh_.tracks = readTracks(file_, scene_, animation, places_, morphs);
    finish();
    return std::move(mesh_);
  }

  /// Reads all but animations.
  AnimatedMesh readStill() {
    readScene();
    finish();
    return std::move(mesh_);
  }

 private:
  /// Reads the scene, and returns the morphs of each of its nodes.
  std::vector<IndexRange> readScene() {
    // 128 bytes per vertex: positions, joints and weights, as read and as kept.
    scene_.open(4 * sizeof(glm::dvec4));
    readNodes();
    std::vector<IndexRange> morphs;
    for (uint32_t n = 0; n < scene_.nodes().size(); ++n) {
      const GltfScene::Node& node = scene_.nodes()[n];
      const std::vector<const Json*>& surfaces = scene_.surfaces(node).list;
      const size_t first = positions_.size();
      const std::vector<uint32_t> places = placesOf(n);
      for (const uint32_t place : places)
        for (const Json* surface : surfaces) readSurface(*surface, *node.json, place);
      morphs.push_back(readMorphs(node, surfaces, first, places.size()));
    }
    scene_.warnOfOthers();
    if (weightless_ > 0)
      file_.warnThat(counted(weightless_, "vertex") + " without weights: their first joint moves them");
    if (halfSkinned_ > 0)
      file_.warnThat(
          counted(halfSkinned_, "vertex") +
          " with a skin but no JOINTS_0, or with JOINTS_0 but no skin: their node alone moves them");
    if (crowded_ > 0)
      file_.warnThat(counted(crowded_, "vertex") +
                     " with more than four joints: the four of the largest weights move them");
    return morphs;
  }

  void readNodes() {
    for (const GltfScene::Node& node : scene_.nodes()) {
      AnimatedMesh::Node& place = mesh_.nodes.emplace_back();
      place.parent = node.parent;
      if (node.json->contains("matrix")) {
        place.matrix = scene_.transform(node);
        continue;
      }
      const std::vector<double> t = scene_.numbers(node, "translation", 3);
      const std::vector<double> r = scene_.numbers(node, "rotation", 4);
      const std::vector<double> s = scene_.numbers(node, "scale", 3);
      if (!t.empty()) place.translation = {t[0], t[1], t[2]};
      if (!r.empty()) place.rotation = {r[3], r[0], r[1], r[2]};
      if (!s.empty()) place.scale = {s[0], s[1], s[2]};
    }
  }

  /// Returns the nodes that show the mesh of a node: itself, or one for each of its instances.
  std::vector<uint32_t> placesOf(uint32_t n) {
    const GltfScene::Node& node = scene_.nodes()[n];
    const auto instances = scene_.instances(node);
    if (!instances) return {n};
    if (node.json->contains("skin"))
      file_.fail("nodes[" + std::to_string(node.index) +
                 "] has a skin and instances, which mean nothing together; remove one of them");
    std::vector<uint32_t> places;
    for (const GltfScene::Placement& each : *instances) {
      places.push_back(static_cast<uint32_t>(mesh_.nodes.size()));
      mesh_.nodes.push_back({.parent = static_cast<int>(n),
                             .translation = each.translation,
                             .rotation = each.rotation,
                             .scale = each.scale});
    }
    return places;
  }

  /// Reads a surface of the node `json`, which moves as the node `node` of the mesh does.
  void readSurface(const Json& surface, const Json& json, uint32_t node) {
    const std::vector<glm::dvec3> positions = scene_.positions(surface);
    const auto first = static_cast<uint32_t>(positions_.size());
    if (positions_.size() + positions.size() >= UINT32_MAX) file_.fail("more than 2^32 vertices");
    positions_.insert(positions_.end(), positions.begin(), positions.end());
    const bool hasSkin = json.contains("skin"), hasJoints = surface["attributes"].contains("JOINTS_0");
    const bool isSkinned = hasSkin && hasJoints;
    if (hasSkin != hasJoints) halfSkinned_ += positions.size();
    const IndexRange joints = isSkinned ? skinJoints(document_.number(json, "skin")) : nodeJoint(node);
    if (isSkinned) {
      readInfluences(surface, positions.size(), joints);
    } else {
      mesh_.joints.resize(positions_.size(), glm::u16vec4(static_cast<uint16_t>(joints.first)));
      mesh_.weights.resize(positions_.size(), glm::vec4(1.0F, 0.0F, 0.0F, 0.0F));
    }
    surfaces_.push_back({triangles_.size(), joints.first});
    for (const glm::uvec3& triangle : scene_.triangles(surface, positions.size()))
      triangles_.push_back(triangle + first);
  }

  size_t targetCount(const Json& surface) const {
    const auto found = surface.find("targets");
    if (found == surface.end()) return 0;
    if (!found->is_array()) file_.fail("the morph 'targets' of a primitive are not a list");
    return found->size();
  }

  /// Reads the morph targets of the surfaces of a node, whose vertices begin at `first`. One target moves all
  /// its instances.
  IndexRange readMorphs(const GltfScene::Node& node, const std::vector<const Json*>& surfaces, size_t first,
                        size_t instances) {
    const size_t count = surfaces.empty() ? 0 : targetCount(*surfaces[0]);
    IndexRange range{static_cast<uint32_t>(mesh_.morphs.size()), static_cast<uint32_t>(count)};
    for (const Json* surface : surfaces)
      if (targetCount(*surface) != count)
        file_.fail("a mesh has primitives with " + std::to_string(count) + " and with " +
                   counted(targetCount(*surface), "morph target"));
    if (count == 0) return range;
    std::vector<double> weights = scene_.numbers(node, "weights", count);
    if (weights.empty()) {
      const uint64_t mesh = document_.number(*node.json, "mesh");
      weights = document_.numbers(document_.element("meshes", mesh), "meshes[" + std::to_string(mesh) + "]",
                                  "weights", count);
    }
    weights.resize(count, 0.0);
    for (size_t t = 0; t < count; ++t) {
      countBytes((positions_.size() - first) * sizeof(glm::vec3));
      AnimatedMesh::Morph morph{.weight = weights[t], .firstVertex = static_cast<uint32_t>(first)};
      for (size_t i = 0; i < instances; ++i)
        for (const Json* surface : surfaces) readTarget((*surface)["targets"][t], *surface, morph.offsets);
      if (morph.offsets.size() != positions_.size() - first)
        file_.fail("its Draco data have " + counted(positions_.size() - first, "vertex") + ", and " +
                   counted(morph.offsets.size(), "offset") + " of a morph target move them");
      mesh_.morphs.push_back(std::move(morph));
    }
    return range;
  }

  /// Appends the offsets of a surface's vertices.
  void readTarget(const Json& target, const Json& surface, std::vector<glm::vec3>& offsets) {
    const size_t count = document_.accessorCount(document_.number(surface["attributes"], "POSITION"));
    if (!target.is_object()) file_.fail("a morph target is not an object");
    const size_t first = offsets.size();
    offsets.resize(first + count, glm::vec3(0.0F));
    if (!target.contains("POSITION")) return;
    const uint64_t accessor = document_.number(target, "POSITION");
    countBytes(count * 2 * sizeof(glm::dvec3));
    const std::vector<glm::dvec3> read = document_.offsets(accessor, count);
    for (size_t v = 0; v < count; ++v) {
      if (!std::isfinite(float(read[v].x + read[v].y + read[v].z)))
        file_.fail("accessors[" + std::to_string(accessor) + "]: the offset of vertex " + std::to_string(v) +
                   " of a morph target is not finite: " + numberText(read[v].x) + ", " +
                   numberText(read[v].y) + ", " + numberText(read[v].z));
      offsets[first + v] = glm::vec3(read[v]);
    }
  }

  IndexRange append(const std::vector<AnimatedMesh::Joint>& joints) {
    const IndexRange range{static_cast<uint32_t>(mesh_.skeleton.size()),
                           static_cast<uint32_t>(joints.size())};
    constexpr size_t kMost = 65536;
    if (mesh_.skeleton.size() + joints.size() > kMost)
      throw Error(ErrorCode::Unsupported, file_.path.string() + ": more than 65536 joints");
    mesh_.skeleton.insert(mesh_.skeleton.end(), joints.begin(), joints.end());
    return range;
  }

  IndexRange nodeJoint(uint32_t node) {
    const auto [found, isNew] = nodeJoints_.try_emplace(node);
    if (isNew) found->second = append(std::vector<AnimatedMesh::Joint>{{.node = node}});
    return found->second;
  }

  IndexRange skinJoints(uint64_t skin) {
    const auto [found, isNew] = skinJoints_.try_emplace(skin);
    if (isNew) found->second = append(readSkin(skin));
    return found->second;
  }

  std::vector<AnimatedMesh::Joint> readSkin(uint64_t skin) {
    const std::string what = "skins[" + std::to_string(skin) + "]";
    const Json& json = document_.element("skins", skin);
    std::vector<AnimatedMesh::Joint> joints;
    for (const uint64_t node : document_.indices(json, "joints")) {
      if (node >= places_.size() || places_[node] < 0)
        file_.fail(what + ": joint " + std::to_string(joints.size()) + " is node " + std::to_string(node) +
                   ", which is not in the scene");
      joints.push_back({.node = static_cast<uint32_t>(places_[node])});
    }
    if (joints.empty()) file_.fail(what + " has no joints");
    if (!json.contains("inverseBindMatrices")) return joints;
    const uint64_t accessor = document_.number(json, "inverseBindMatrices");
    countBytes(document_.accessorCount(accessor) * sizeof(glm::dmat4));
    const std::vector<double> numbers = document_.reals(accessor, "MAT4", 16);
    if (numbers.size() < 16 * joints.size())
      file_.fail(what + " has " + counted(joints.size(), "joint") + ", but " +
                 std::to_string(numbers.size() / 16) + " inverse bind matrices");
    for (size_t i = 0; i < 16 * joints.size(); ++i) {
      if (!std::isfinite(numbers[i]))
        file_.fail(what + ": the inverse bind matrix of joint " + std::to_string(i / 16) +
                   " is not finite: its number " + std::to_string(i % 16) + " is " + numberText(numbers[i]));
      joints[i / 16].inverseBind[static_cast<int>(i % 16 / 4)][static_cast<int>(i % 4)] = numbers[i];
    }
    return joints;
  }

  /// Counts bytes and checks their sum. Skins may share accessors, so a small file could request any amount
  /// of memory or time.
  void countBytes(uint64_t bytes) {
    bytes_ += bytes;
    checkMemory(file_, bytes_);
  }

  struct Influence {
    double weight;
    uint32_t joint;
  };
  struct Surface {
    size_t firstTriangle;
    uint32_t joint;
  };

  /// Reads joints and weights, which come in sets of four per vertex.
  void readInfluences(const Json& surface, size_t vertexCount, IndexRange joints) {
    const Json& attributes = surface["attributes"];
    std::vector<std::vector<double>> numbers, weights;
    for (int set = 0; attributes.contains("JOINTS_" + std::to_string(set)); ++set) {
      numbers.push_back(readSet(surface, "JOINTS_" + std::to_string(set), vertexCount));
      checkJointType(document_.number(attributes, ("JOINTS_" + std::to_string(set)).c_str()));
      weights.push_back(readSet(surface, "WEIGHTS_" + std::to_string(set), vertexCount));
    }
    std::vector<Influence> influences;
    for (size_t v = 0; v < vertexCount; ++v) {
      influences.clear();
      for (size_t i = 4 * v; i < 4 * v + 4; ++i)
        for (size_t set = 0; set < numbers.size(); ++set)
          influences.push_back(checked({weights[set][i], static_cast<uint32_t>(numbers[set][i])}, joints, v));
      appendInfluences(influences, joints.first);
    }
  }

  std::vector<double> readSet(const Json& surface, const std::string& name, size_t vertexCount) {
    const uint64_t accessor = document_.number(surface["attributes"], name.c_str());
    countBytes(document_.accessorCount(accessor) * sizeof(glm::dvec4));
    return scene_.attribute(surface, name, "VEC4", 4, vertexCount);
  }

  void checkJointType(uint64_t accessor) const {
    constexpr uint64_t kUInt8 = 5121, kUInt16 = 5123;  // Numbered as in the file.
    const uint64_t type = document_.number(document_.element("accessors", accessor), "componentType");
    if (type != kUInt8 && type != kUInt16)
      file_.fail("accessors[" + std::to_string(accessor) + "] holds joints of componentType " +
                 std::to_string(type));
  }

  Influence checked(Influence influence, IndexRange joints, size_t vertex) const {
    if (!(influence.weight >= 0.0) || !std::isfinite(influence.weight))
      file_.fail("vertex " + std::to_string(vertex) + " of a skin has the weight " +
                 numberText(influence.weight) + "; weights must be finite and not negative");
    if (influence.weight == 0.0) return {0.0, 0};
    if (influence.joint >= joints.count)
      file_.fail("vertex " + std::to_string(vertex) + " of a skin follows joint " +
                 std::to_string(influence.joint) + " of " + std::to_string(joints.count));
    if (isSingular(mesh_.skeleton[joints.first + influence.joint].inverseBind))
      file_.fail("vertex " + std::to_string(vertex) + " of a skin follows joint " +
                 std::to_string(influence.joint) +
                 ", whose inverse bind matrix is singular: it would flatten the mesh; export the skin again");
    return influence;
  }

  void appendInfluences(std::vector<Influence>& influences, uint32_t firstJoint) {
    std::stable_sort(influences.begin(), influences.end(),
                     [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    if (influences.size() > 4 && influences[4].weight > 0.0) ++crowded_;
    influences.resize(4);
    double sum = 0.0;
    for (const Influence& influence : influences) sum += influence.weight;
    if (sum == 0.0) {
      ++weightless_;
      influences[0].weight = sum = 1.0;
    }
    mesh_.joints.emplace_back();
    mesh_.weights.emplace_back();
    for (int k = 0; k < 4; ++k) {
      const Influence& influence = influences[static_cast<size_t>(k)];
      mesh_.joints.back()[k] = static_cast<uint16_t>(firstJoint + influence.joint);
      mesh_.weights.back()[k] = static_cast<float>(influence.weight / sum);
    }
  }

  /// Reverses surfaces that their joints mirror when the animation begins.
  void turnMirrored() {
    const std::vector<JointMatrix> matrices = jointMatrices(mesh_, 0.0);
    for (size_t s = 0; s < surfaces_.size(); ++s) {
      const size_t first = surfaces_[s].firstTriangle;
      const size_t end = s + 1 < surfaces_.size() ? surfaces_[s + 1].firstTriangle : triangles_.size();
      const auto& rows = matrices[surfaces_[s].joint].rows;
      const glm::mat3 turn{glm::vec3(rows[0]), glm::vec3(rows[1]), glm::vec3(rows[2])};
      if (glm::determinant(turn) < 0.0F) turnOver(std::span(triangles_).subspan(first, end - first));
    }
  }

  void finish() {
    turnMirrored();
    mesh_.rest = finishMesh(file_, std::move(positions_), std::move(triangles_));
    mesh_.origin = bounds(posed(mesh_, 0.0)).centre();
    const glm::dvec3& at = mesh_.origin;
    if (!std::isfinite(at.x + at.y + at.z)) file_.fail("its joints move it beyond single precision");
    validate(mesh_);
  }

  const MeshFile& file_;
  GltfScene scene_;
  const GltfDocument& document_;
  std::vector<int> places_;
  AnimatedMesh mesh_;
  std::vector<glm::dvec3> positions_;
  std::vector<glm::uvec3> triangles_;
  std::vector<Surface> surfaces_;
  std::map<uint32_t, IndexRange> nodeJoints_;
  std::map<uint64_t, IndexRange> skinJoints_;
  uint64_t weightless_ = 0, crowded_ = 0, halfSkinned_ = 0, bytes_ = 0;
};

}  // namespace

Mesh readStandingGltf(const MeshFile& file) {
  return posed(AnimatedReader(file).readStill(), 0.0);
}

AnimatedMesh readAnimatedGltf(const MeshFile& file, size_t animation) {
  return AnimatedReader(file).read(animation);
}

AnimatedMesh readAnimatedGltf(const MeshFile& file, const std::string& clip) {
  return AnimatedReader(file).read(clip);
}

}  // namespace raymap
