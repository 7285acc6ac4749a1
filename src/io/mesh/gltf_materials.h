#pragma once

#include <raymap/buffer.h>

#include <nlohmann/json.hpp>
#include <vector>

namespace raymap {

/// Materials of a glTF with their textures and images, which are not interpreted.
struct GltfMaterials {
  nlohmann::json root =
      nlohmann::json::object();  ///< Arrays of the file; `bufferView` is an index of `images`.
  std::vector<Buffer<std::byte>> images = {};
};

}  // namespace raymap
