// 3MF, core specification 1.4 with the production extension 1.2: a zip of XML parts.

#include <raymap/error.h>

#include <algorithm>
#include <deque>
#include <optional>

#include "base/text.h"
#include "io/3mf/model_part.h"
#include "io/3mf/properties.h"
#include "io/3mf/slicer_parts.h"
#include "io/3mf/units.h"
#include "io/3mf/xml_parser.h"
#include "mesh/attribute_words.h"

namespace raymap {

namespace {

constexpr int kDeepest = 64;  // Components in components.

/// Finds the part that the package starts with.
class StartPart : public XmlHandler {
 public:
  void start(const XmlName& name, const XmlAttributes& attributes) override {
    constexpr std::string_view kModel = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
    const auto target = attributes.find("Target");
    if (!path && target && name.local == "Relationship" && attributes.find("Type") == kModel) path = *target;
  }
  void end() override {}

  std::optional<std::string> path;
};

std::string findRoot(ZipParts& parts) {
  constexpr const char* kRelationships = "_rels/.rels";
  StartPart found;
  parseXml(parts, kRelationships, found);
  if (!found.path) parts.file().fail(std::string(kRelationships) + ": it names no 3D model");
  return partName(parts, *found.path);
}

/// An object, and what it adds up to with its components.
struct Node {
  enum class State : uint8_t { New, Open, Counted };
  const Object3mf* object = nullptr;
  State state = State::New;
  uint64_t vertices = 0, triangles = 0, placements = 0;
  int height = 0;  ///< How deeply components are nested in it.
};

class Scene3mf {
 public:
  explicit Scene3mf(ZipParts& parts) : parts_(parts), root_(findRoot(parts)) {
    readParts();
    for (const auto& [id, unprinted] : readSlicerParts(parts_))
      if (const auto found = models_.at(root_).objects.find(id); found != models_.at(root_).objects.end())
        found->second.unprinted = removeUnprinted(parts_.file(), found->second, unprinted);
    for (const auto& [name, part] : models_)
      for (const auto& [id, object] : part.objects) nodes_[{name, id}].object = &object;
  }

  Mesh mesh() {
    warnOfUnit();
    const ModelPart3mf& root = models_.at(root_);
    Node all;
    for (const Placement3mf& item : root.items) add(all, item, root_, 0);
    warnOfRest(root);
    positions_.reserve(all.vertices);
    triangles_.reserve(all.triangles);
    for (const Placement3mf& item : root.items) append(item, glm::dmat4(1.0), "");
    if (triangles_.empty() && !parts_.file().allowEmpty)
      parts_.file().fail(root_ + ": its build places no triangles");
    if (MeshAttributes* attributes = parts_.file().attributes) {
      const auto isPainted = [](const auto& model) { return model.second.isPainted; };
      if (std::ranges::any_of(models_, isPainted)) attributes->lost.emplace_back("painted colours");
    }
    properties_.finish();
    models_.clear();
    return finishMesh(parts_.file(), std::move(positions_), std::move(triangles_));
  }

 private:
  /// Reads the root and all parts that components and items refer to.
  void readParts() {
    std::deque<std::string> names{root_};
    for (; !names.empty(); names.pop_front()) {
      const std::string& name = names.front();
      if (models_.contains(name)) continue;
      const ModelPart3mf& part = models_.emplace(name, readModelPart(parts_, name)).first->second;
      follow(name, part.items, names);
      for (const auto& [id, object] : part.objects) follow(name, object.components, names);
    }
  }

  /// Appends the parts that placements in the part `from` refer to and that were not read yet.
  void follow(const std::string& from, const std::vector<Placement3mf>& placements,
              std::deque<std::string>& names) const {
    for (const Placement3mf& each : placements) {
      if (models_.contains(each.part)) continue;
      if (!parts_.has(each.part))
        fail(from, each.line, "there is no part " + excerpt(each.part, kLongestName));
      names.push_back(each.part);
    }
  }

  [[noreturn]] void fail(const std::string& part, uint64_t line, const std::string& what) const {
    parts_.file().fail(part + ", line " + std::to_string(line) + ": " + what);
  }

  /// Adds what a placement in `part` places to the sums of the node that holds it.
  void add(Node& sums, const Placement3mf& placed, const std::string& part, int depth) {
    const auto found = nodes_.find({placed.part, placed.object});
    const std::string name = "object " + std::to_string(placed.object);
    if (found == nodes_.end()) fail(part, placed.line, placed.part + " has no " + name);
    Node& node = found->second;
    if (node.state == Node::State::Open) fail(part, placed.line, name + " contains itself");
    if (node.state == Node::State::New && depth <= kDeepest) {
      noteUnprinted(node.object->unprinted, placed.part + ": " + name);
      count(node, placed.part, depth);
    }
    sums.height = std::max(sums.height, node.height + 1);
    if (depth + node.height > kDeepest)
      fail(part, placed.line, "components are nested more than " + std::to_string(kDeepest) + " deep");
    sums.vertices += node.vertices;
    sums.triangles += node.triangles;
    sums.placements += node.triangles > 0 ? node.placements + 1 : 0;
    checkExpansion(parts_.file(),
                   sums.vertices * sizeof(glm::dvec3) + sums.triangles * sizeof(glm::uvec3) +
                       sums.placements * kBytesPerInstance,
                   parts_.file().bytes.size());
    if (sums.vertices > UINT32_MAX || sums.triangles > UINT32_MAX)
      throw Error(ErrorCode::Unsupported,
                  parts_.file().path.string() + ": more than 2^32 triangles or vertices");
  }

  void count(Node& node, const std::string& part, int depth) {
    node.state = Node::State::Open;
    const Object3mf& object = *node.object;
    if (object.type == "model" || object.type == "surface") {
      node.vertices = object.vertices.size();
      node.triangles = object.triangles.size();
      for (const Placement3mf& component : object.components) add(node, component, part, depth + 1);
    } else {
      ++leftOut_;
    }
    node.state = Node::State::Counted;
  }

  void noteUnprinted(const PartCounts& counts, const std::string& object) {
    for (size_t use = 0; use < counts.size(); ++use) unprinted_[use] += counts[use];
    if (const size_t cuts = counts[static_cast<size_t>(PartUse::CutOut)]; cuts > 0)
      throw Error(ErrorCode::Unsupported,
                  parts_.file().path.string() + ": " + object + " has " + counted(cuts, "negative part") +
                      ", to be cut out of it, and meshes cannot be subtracted here; do that in the slicer "
                      "(a mesh boolean, or its export as STL), or delete the part there");
  }

  /// Gives the triangles that have none yet a name.
  void addPart(const std::string& name) {
    if (!parts_.file().attributes) return;
    MeshAttributes& found = *parts_.file().attributes;
    found.partOf.resize(triangles_.size(), name.empty() ? kNoAttribute : uint32_t(found.parts.size()));
    found.parts.push_back({name});
  }

  /// `owner` is the name of the object that holds this one, for those without a name.
  void append(const Placement3mf& placed, const glm::dmat4& parent, const std::string& owner) {
    const Node& node = nodes_.at({placed.part, placed.object});
    if (node.triangles == 0) return;
    const glm::dmat4 transform = parent * glm::dmat4(placed.transform);
    const auto first = static_cast<uint32_t>(positions_.size());
    for (const glm::dvec3& vertex : node.object->vertices)
      positions_.emplace_back(transform * glm::dvec4(vertex, 1.0));
    const bool isMirrored = glm::determinant(glm::dmat3(transform)) < 0.0;
    for (glm::uvec3 triangle : node.object->triangles) {
      if (isMirrored) std::swap(triangle.y, triangle.z);
      triangles_.push_back(triangle + first);
    }
    properties_.append(models_.at(placed.part), *node.object, isMirrored);
    const std::string& name = node.object->name.empty() ? owner : node.object->name;
    if (!node.object->triangles.empty()) addPart(name);
    for (const Placement3mf& component : node.object->components) append(component, transform, name);
  }

  void warnOfUnit() const {
    for (const auto& [name, part] : models_)
      if (part.unit != "millimeter")
        parts_.file().warnThat(name + " is in the unit " + part.unit + "; converted to millimetres");
  }

  void warnOfRest(const ModelPart3mf& root) const {
    if (root.unprintedItems > 0)
      parts_.file().warnThat(counted(root.unprintedItems, "item") +
                             " of the build left out, for printable is 0");
    if (leftOut_ > 0)
      parts_.file().warnThat(counted(leftOut_, "object") +
                             " of type support, solidsupport or other left out");
    if (const std::string left = unprintedParts(unprinted_); !left.empty())
      parts_.file().warnThat(left + " left out, for the slicer's project does not print such parts");
  }

  ZipParts& parts_;
  std::string root_;
  std::map<std::string, ModelPart3mf> models_;
  std::map<std::pair<std::string, uint32_t>, Node> nodes_;
  size_t leftOut_ = 0;
  PartCounts unprinted_{};  ///< Parts left out of all objects that are placed.
  std::vector<glm::dvec3> positions_;
  std::vector<glm::uvec3> triangles_;
  PropertyReader properties_{parts_.file()};
};

}  // namespace

std::string partName(const ZipParts& parts, std::string_view path) {
  if (path.starts_with('/')) path.remove_prefix(1);
  if (parts.has(path)) return std::string(path);
  return unescapedUri(path);
}

Mesh read3mf(const MeshFile& file) {
  ZipParts parts(file);
  return Scene3mf(parts).mesh();
}

}  // namespace raymap
