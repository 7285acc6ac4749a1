#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace raymap {

/// A mesh that Draco has compressed.
struct DracoRequest {
  std::span<const std::byte> bytes;
  std::vector<uint32_t> attributes;  ///< Unique numbers of those to decode.
};

struct DracoMesh {
  struct Attribute {
    uint64_t components = 0;
    std::vector<double> numbers;  ///< Those of the first vertex come first.
  };
  uint64_t vertices = 0;
  std::vector<glm::uvec3> triangles;
  std::vector<Attribute> attributes;  ///< In the order of the request.
};

/// Decodes meshes of a file in a child process (see Importer). Fails if one is damaged, or all together are
/// far too large for `fileBytes` bytes.
std::vector<DracoMesh> importDraco(const MeshFile& file, std::span<const DracoRequest> requests,
                                   uint64_t fileBytes);

}  // namespace raymap
