#pragma once

#include <map>
#include <span>
#include <string>

#include "io/gltf/gltf_document.h"

namespace raymap {

/// The data of a primitive that KHR_draco_mesh_compression has compressed.
struct DracoSurface {
  struct Attribute {
    uint64_t components = 0;
    std::vector<double> numbers;
  };
  uint64_t vertices = 0;
  std::vector<glm::uvec3> triangles;
  std::map<std::string, Attribute> attributes;  ///< Those that are read.
};

/// Returns whether a primitive has its data in compressed form alone. If they are in the file twice, the
/// uncompressed ones are read: they are exact.
bool needsDraco(const GltfDocument& document, const GltfDocument::Json& primitive);

/// Decodes all primitives of a list that need it.
std::map<const GltfDocument::Json*, DracoSurface> decodeDraco(
    const MeshFile& file, const GltfDocument& document, std::span<const GltfDocument::Json* const> surfaces);

}  // namespace raymap
