#include "io/mesh/base_colour.h"

#include <algorithm>
#include <cmath>

namespace raymap {

namespace {

const nlohmann::json::json_pointer kFactor("/pbrMetallicRoughness/baseColorFactor");

double linear(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

double encoded(double value) {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
}

}  // namespace

glm::vec4 linearColour(const glm::vec4& colour) {
  return {linear(colour.x), linear(colour.y), linear(colour.z), colour.w};
}

glm::vec4 encodedColour(const glm::vec4& colour) {
  return {encoded(colour.x), encoded(colour.y), encoded(colour.z), colour.w};
}

nlohmann::json gltfMaterial(const std::string& name, const glm::vec4& colour) {
  nlohmann::json material = {
      {"name", name},
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {linear(colour.x), linear(colour.y), linear(colour.z), colour.w}},
        {"metallicFactor", 0.0}}}};
  if (colour.w < 1.0F) material["alphaMode"] = "BLEND";
  return material;
}

glm::vec4 baseColour(const nlohmann::json& material) {
  glm::vec4 colour(1.0F);
  if (!material.is_object() || !material.contains(kFactor)) return colour;
  const nlohmann::json& factor = material[kFactor];
  if (!factor.is_array() || factor.size() != 4) return colour;
  for (int c = 0; c < 4; ++c) {
    if (!factor[size_t(c)].is_number()) return glm::vec4(1.0F);
    const double value = std::clamp(factor[size_t(c)].get<double>(), 0.0, 1.0);
    colour[c] = float(std::round(255.0 * (c < 3 ? encoded(value) : value))) / 255.0F;
  }
  return colour;
}

bool isBaseColour(const nlohmann::json& material) {
  if (!material.is_object()) return false;
  nlohmann::json plain = gltfMaterial("", baseColour(material)), given = material;
  if (material.contains(kFactor)) plain[kFactor] = material[kFactor];  // Before it was rounded.
  given["name"] = "";
  return given == plain;
}

}  // namespace raymap
