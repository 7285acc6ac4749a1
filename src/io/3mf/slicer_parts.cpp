// Projects of slicers: a 3MF holds the parts that steer the slicer as if they were solid. A file of the
// slicer's own, in Metadata, says which these are.

#include "io/3mf/slicer_parts.h"

#include <algorithm>
#include <charconv>
#include <deque>
#include <string_view>

#include "base/text.h"
#include "io/3mf/xml_parser.h"

namespace raymap {

namespace {

/// The files: PrusaSlicer's and those of slicers made from it, then that of Orca and Bambu Studio.
constexpr std::array<const char*, 2> kConfigs{"Metadata/Slic3r_PE_model.config",
                                              "Metadata/model_settings.config"};

struct UseName {
  std::string_view name;
  PartUse use;
};
constexpr std::array kUseNames{UseName{"ModelPart", PartUse::Print},
                               UseName{"normal_part", PartUse::Print},
                               UseName{"NegativeVolume", PartUse::CutOut},
                               UseName{"negative_part", PartUse::CutOut},
                               UseName{"ParameterModifier", PartUse::Modify},
                               UseName{"modifier_part", PartUse::Modify},
                               UseName{"SupportBlocker", PartUse::BlockSupport},
                               UseName{"support_blocker", PartUse::BlockSupport},
                               UseName{"SupportEnforcer", PartUse::EnforceSupport},
                               UseName{"support_enforcer", PartUse::EnforceSupport}};

std::optional<uint32_t> wholeNumber(std::optional<std::string_view> text) {
  uint32_t value = 0;
  if (!text || std::from_chars(text->data(), text->data() + text->size(), value).ec != std::errc())
    return std::nullopt;
  return value;
}

/// Reads `config > object > volume or part > metadata`.
class ConfigReader : public XmlHandler {
 public:
  ConfigReader(const MeshFile& file, std::string name, std::map<uint32_t, std::vector<SlicerPart>>& objects)
      : file_(file), name_(std::move(name)), objects_(objects) {}

  void start(const XmlName& name, const XmlAttributes& attributes) override {
    ++depth_;
    if (depth_ == 2) object_ = name.local == "object" ? wholeNumber(attributes.find("id")) : std::nullopt;
    if (depth_ == 3) part_ = nullptr;
    if (depth_ == 3 && object_ && (name.local == "volume" || name.local == "part")) addPart(attributes);
    if (depth_ == 4 && part_ && name.local == "metadata")
      readMetadata(attributes.find("key").value_or(""), attributes.find("value").value_or(""));
  }
  void end() override { --depth_; }

 private:
  void addPart(const XmlAttributes& attributes) {
    part_ = &objects_[*object_].emplace_back();
    part_->where = name_ + ", line " + std::to_string(line());
    const auto first = wholeNumber(attributes.find("firstid")), last = wholeNumber(attributes.find("lastid"));
    if (first && last) part_->triangles.emplace(*first, *last);
    part_->component = wholeNumber(attributes.find("id"));
    if (const auto use = attributes.find("subtype")) setUse(*use);
  }

  void readMetadata(std::string_view key, std::string_view value) {
    if (key == "volume_type" || key == "part_type") setUse(value);
    if (key == "modifier" && value == "1") part_->use = PartUse::Modify;  // Before PrusaSlicer 1.42.
  }

  void setUse(std::string_view name) {
    const auto found = std::ranges::find(kUseNames, name, &UseName::name);
    if (found != kUseNames.end())
      part_->use = found->use;
    else
      file_.warnThat(part_->where + ": a part of object " + std::to_string(*object_) +
                     " has the unknown type " + excerpt(name) + "; read as solid");
  }

  const MeshFile& file_;
  std::string name_;
  std::map<uint32_t, std::vector<SlicerPart>>& objects_;
  int depth_ = 0;
  std::optional<uint32_t> object_;
  SlicerPart* part_ = nullptr;
};

/// Removes triangles, and the vertices that they alone use.
void removeTriangles(Object3mf& object, const std::vector<bool>& isRemoved) {
  std::vector<bool> isLost(object.vertices.size());
  for (size_t t = 0; t < isRemoved.size(); ++t)
    for (int c = 0; c < 3 && isRemoved[t]; ++c) isLost[object.triangles[t][c]] = true;
  std::vector<glm::uvec3> kept;
  for (size_t t = 0; t < isRemoved.size(); ++t) {
    if (isRemoved[t]) continue;
    kept.push_back(object.triangles[t]);
    if (t < object.properties.size()) object.properties[kept.size() - 1] = object.properties[t];
    for (int c = 0; c < 3; ++c) isLost[kept.back()[c]] = false;
  }
  std::vector<uint32_t> places(object.vertices.size());
  uint32_t count = 0;
  for (size_t v = 0; v < places.size(); ++v) {
    places[v] = count;
    if (!isLost[v]) object.vertices[count++] = object.vertices[v];
  }
  object.vertices.resize(count);
  for (glm::uvec3& triangle : kept)
    for (int c = 0; c < 3; ++c) triangle[c] = places[triangle[c]];
  object.triangles = std::move(kept);
}

/// Returns the uses of an object's components. If several parts name one object, the first one is that of the
/// first such component, and so on.
std::vector<PartUse> usesOfComponents(const Object3mf& object, const std::vector<SlicerPart>& parts) {
  std::map<uint32_t, std::deque<PartUse>> uses;
  for (const SlicerPart& part : parts)
    if (part.component) uses[*part.component].push_back(part.use);
  std::vector<PartUse> result;
  for (const Placement3mf& component : object.components) {
    const auto found = uses.find(component.object);
    result.push_back(found == uses.end() ? PartUse::Print : found->second.front());
    if (found != uses.end() && found->second.size() > 1) found->second.pop_front();
  }
  return result;
}

}  // namespace

PartCounts removeUnprinted(const MeshFile& file, Object3mf& object, const std::vector<SlicerPart>& parts) {
  PartCounts counts{};
  // How many removed parts begin at a triangle, less those that end before it.
  std::vector<int64_t> steps(object.triangles.size() + 1);
  for (const SlicerPart& part : parts) {
    if (part.use == PartUse::Print || !part.triangles) continue;
    const auto [first, last] = *part.triangles;
    if (first > last || last >= object.triangles.size())
      file.fail(part.where + ": a part has the triangles " + std::to_string(first) + " to " +
                std::to_string(last) + " of an object with " + counted(object.triangles.size(), "triangle"));
    ++counts[static_cast<size_t>(part.use)];
    ++steps[first];
    --steps[last + 1];
  }
  if (counts != PartCounts{}) {
    std::vector<bool> isRemoved(object.triangles.size());
    int64_t depth = 0;
    for (size_t t = 0; t < isRemoved.size(); ++t) isRemoved[t] = (depth += steps[t]) > 0;
    removeTriangles(object, isRemoved);
  }
  const std::vector<PartUse> uses = usesOfComponents(object, parts);
  std::vector<Placement3mf> kept;
  for (size_t c = 0; c < uses.size(); ++c) {
    if (uses[c] == PartUse::Print)
      kept.push_back(std::move(object.components[c]));
    else
      ++counts[static_cast<size_t>(uses[c])];
  }
  object.components = std::move(kept);
  return counts;
}

std::map<uint32_t, std::vector<SlicerPart>> readSlicerParts(ZipParts& parts) {
  std::map<uint32_t, std::vector<SlicerPart>> objects;
  for (const char* config : kConfigs) {
    if (!parts.has(config)) continue;
    ConfigReader reader(parts.file(), config, objects);
    parseXml(parts, config, reader, XmlPrefixes::Plain);  // PrusaSlicer declares no namespace for its prefix.
  }
  return objects;
}

std::string unprintedParts(const PartCounts& counts) {
  std::vector<std::string> kinds;
  const auto add = [&](PartUse use, std::string_view noun) {
    if (const size_t count = counts[static_cast<size_t>(use)]; count > 0)
      kinds.push_back(counted(count, noun));
  };
  add(PartUse::Modify, "modifier");
  add(PartUse::BlockSupport, "support blocker");
  add(PartUse::EnforceSupport, "support enforcer");
  std::string text;
  for (size_t i = 0; i < kinds.size(); ++i)
    text += (i == 0 ? "" : i + 1 == kinds.size() ? " and " : ", ") + kinds[i];
  return text;
}

}  // namespace raymap
