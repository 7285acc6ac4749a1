#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>

namespace raymap {

// Colours of a mesh are sRGB, those of a glTF are linear.
glm::vec4 linearColour(const glm::vec4& colour);
glm::vec4 encodedColour(const glm::vec4& colour);

/// Returns a glTF's material of a base colour (sRGB and alpha, from 0 to 1).
nlohmann::json gltfMaterial(const std::string& name, const glm::vec4& colour);

/// Returns the base colour of a glTF's material in 8 bits, as `gltfMaterial` takes it; white if it has
/// none that is valid.
glm::vec4 baseColour(const nlohmann::json& material);

/// Returns whether a glTF's material has no look but a base colour.
bool isBaseColour(const nlohmann::json& material);

}  // namespace raymap
