#include "io/3mf/properties.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "io/3mf/xml_text.h"
#include "io/mesh/base_colour.h"

namespace raymap {

namespace {

uint32_t packed(const glm::vec4& colour) {
  uint32_t bytes = 0;
  for (int c = 0; c < 4; ++c)  // What is no number becomes 0.
    bytes =
        bytes << 8U | uint32_t(std::lround(255.0F * (colour[c] > 0.0F ? std::min(colour[c], 1.0F) : 0.0F)));
  return bytes;
}

std::string colourText(uint32_t bytes) {
  char text[16];
  const bool isOpaque = (bytes & 0xffU) == 0xff;
  std::snprintf(text, sizeof(text), isOpaque ? "#%06X" : "#%08X", isOpaque ? bytes >> 8U : bytes);
  return text;
}

/// Returns an XML attribute with a number.
std::string numbered(const char* name, size_t value) {
  return " " + std::string(name) + "=\"" + std::to_string(value) + "\"";
}

bool hasMaterial(const MeshAttributes& attributes, size_t face) {
  return !attributes.materialOf.empty() && attributes.materialOf[face] != kNoAttribute;
}

/// Returns whether a triangle has colours at all corners, and not just the white that leaves its material as
/// it is.
bool isColoured(const MeshAttributes& attributes, size_t face) {
  const CornerValues<glm::vec4>& given = attributes.colours;
  if (given.corners.empty()) return false;
  bool isWhite = true;
  for (int c = 0; c < 3; ++c) {
    const uint32_t id = given.corners[face][c];
    if (id == kNoAttribute) return false;
    isWhite = isWhite && packed(given.values[id]) == UINT32_MAX;
  }
  return !isWhite || !hasMaterial(attributes, face);
}

nlohmann::json lookOf(const MeshAttributes& attributes, size_t material) {
  if (!attributes.gltf || !attributes.gltf->root.contains("materials")) return {};
  const nlohmann::json& all = attributes.gltf->root["materials"];
  return material < all.size() ? all[material] : nlohmann::json();
}

}  // namespace

uint32_t PropertyReader::firstOf(const PropertyGroup3mf& group) {
  MeshAttributes& found = *file_.attributes;
  const bool isMaterial = group.kind == PropertyGroup3mf::Kind::Materials;
  const auto first = uint32_t(isMaterial ? found.materials.size() : found.colours.values.size());
  const auto [place, isNew] = firsts_.try_emplace(&group, first);
  if (!isNew) return place->second;
  if (!isMaterial)
    found.colours.values.insert(found.colours.values.end(), group.colours.begin(), group.colours.end());
  for (size_t m = 0; m < group.colours.size() && isMaterial; ++m) {
    const std::string& name = group.names[m];
    found.materials.push_back(name.empty() ? "material " + std::to_string(found.materials.size()) : name);
    looks_.root["materials"].push_back(gltfMaterial(found.materials.back(), group.colours[m]));
  }
  return first;
}

void PropertyReader::append(const PropertyGroup3mf& group, const glm::uvec3& indices) {
  if (group.kind == PropertyGroup3mf::Kind::Other) {
    ++others_;
    return;
  }
  if (glm::any(glm::greaterThanEqual(indices, glm::uvec3(uint32_t(group.colours.size()))))) {
    ++malformed_;
    return;
  }
  const uint32_t first = firstOf(group);
  if (group.kind == PropertyGroup3mf::Kind::Materials)
    materialOf_.back() = first + indices.x;
  else
    colours_.back() = first + indices;
}

void PropertyReader::append(const ModelPart3mf& part, const Object3mf& object, bool isMirrored) {
  if (!file_.attributes) return;
  for (size_t f = 0; f < object.triangles.size(); ++f) {
    materialOf_.push_back(kNoAttribute);
    colours_.emplace_back(kNoAttribute);
    const Property3mf property = f < object.properties.size() ? object.properties[f] : object.property;
    if (property.group == kNoAttribute) continue;
    glm::uvec3 indices = property.indices;
    if (isMirrored) std::swap(indices.y, indices.z);
    if (const auto group = part.groups.find(property.group); group == part.groups.end())
      ++malformed_;
    else
      append(group->second, indices);
  }
}

void PropertyReader::finish() {
  if (!file_.attributes) return;
  MeshAttributes& found = *file_.attributes;
  if (!found.materials.empty()) {
    found.materialOf = std::move(materialOf_);
    found.gltf = std::make_shared<const GltfMaterials>(std::move(looks_));
  }
  if (!found.colours.values.empty()) found.colours.corners = std::move(colours_);
  if (others_ > 0) found.lost.push_back("textures or mixed materials of " + counted(others_, "triangle"));
  if (malformed_ > 0)
    file_.warnThat("materials or colours of " + counted(malformed_, "triangle") +
                   " have an unknown group or an index out of range, and are left out");
}

PropertyText::PropertyText(const MeshAttributes* attributes, size_t firstId)
    : attributes_(attributes), firstId_(firstId) {
  if (!attributes) return;
  const CornerValues<glm::vec4>& given = attributes->colours;
  std::vector<bool> isUsed(given.values.size());
  for (size_t f = 0; f < given.corners.size(); ++f)
    for (int c = 0; c < 3 && isColoured(*attributes, f); ++c) isUsed[given.corners[f][c]] = true;
  for (size_t v = 0; v < isUsed.size(); ++v)
    if (isUsed[v]) colours_.push_back(packed(given.values[v]));
  std::ranges::sort(colours_);
  colours_.erase(std::unique(colours_.begin(), colours_.end()), colours_.end());
}

std::string PropertyText::groups() const {
  std::string text;
  if (attributes_ && !attributes_->materialOf.empty() && !attributes_->materials.empty()) {
    text += "<basematerials id=\"" + std::to_string(firstId_) + "\">\n";
    for (size_t m = 0; m < attributes_->materials.size(); ++m)
      text += "<base name=\"" + xmlText(attributes_->materials[m]) + "\" displaycolor=\"" +
              colourText(packed(baseColour(lookOf(*attributes_, m)))) + "\"/>\n";
    text += "</basematerials>\n";
  }
  if (colours_.empty()) return text;
  text += "<m:colorgroup id=\"" + std::to_string(firstId_ + 1) + "\">\n";
  for (const uint32_t colour : colours_) text += "<m:color color=\"" + colourText(colour) + "\"/>\n";
  return text + "</m:colorgroup>\n";
}

std::optional<Property3mf> PropertyText::propertyOf(size_t face) const {
  if (!attributes_) return {};
  const auto material = uint32_t(firstId_);
  if (!isColoured(*attributes_, face)) {
    if (!hasMaterial(*attributes_, face)) return {};
    return Property3mf{material, glm::uvec3(attributes_->materialOf[face])};
  }
  Property3mf property{material + 1, {}};
  for (int c = 0; c < 3; ++c) {
    const uint32_t colour = packed(attributes_->colours.values[attributes_->colours.corners[face][c]]);
    property.indices[c] = uint32_t(std::ranges::lower_bound(colours_, colour) - colours_.begin());
  }
  return property;
}

std::string PropertyText::of(size_t face) const {
  const std::optional<Property3mf> property = propertyOf(face);
  if (!property) return {};
  std::string text = numbered("pid", property->group) + numbered("p1", property->indices.x);
  if (property->group != firstId_)
    text += numbered("p2", property->indices.y) + numbered("p3", property->indices.z);
  return text;
}

std::string PropertyText::defaultOf(std::span<const uint32_t> faces, size_t count) const {
  std::map<std::pair<uint32_t, uint32_t>, size_t> counts;
  for (size_t f = 0; f < count; ++f)
    if (const auto property = propertyOf(faces.empty() ? f : faces[f]))
      ++counts[{property->group, property->indices.x}];
  if (counts.empty()) return {};
  const auto most = std::ranges::max_element(counts, {}, [](const auto& each) { return each.second; });
  return numbered("pid", most->first.first) + numbered("pindex", most->first.second);
}

std::vector<std::string> lostIn3mf(const MeshAttributes& attributes) {
  std::vector<std::string> lost;
  size_t both = 0;
  for (size_t f = 0; f < attributes.materialOf.size(); ++f)
    both += isColoured(attributes, f) && hasMaterial(attributes, f) ? 1 : 0;
  if (both > 0) lost.push_back("materials of " + counted(both, "coloured triangle"));
  bool isMore = !attributes.libraries.empty();
  for (size_t m = 0; m < attributes.materials.size(); ++m) {
    const nlohmann::json look = lookOf(attributes, m);
    isMore = isMore || (!look.is_null() && !isBaseColour(look));
  }
  if (isMore) lost.emplace_back("looks of materials");
  return lost;
}

}  // namespace raymap
