#pragma once

#include <raymap/export.h>
#include <raymap/mesh_view.h>

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace raymap {

/// Values at the corners of triangles, such as texture coordinates.
template <class Value>
struct CornerValues {
  std::vector<Value> values = {};
  /// Value at each corner of each triangle; `MeshAttributes::kNone` for none. Empty if there are no values.
  std::vector<glm::uvec3> corners = {};
};

/// Names of a part of a mesh file.
struct MeshPart {
  std::string object = {};  ///< Name of an object of an OBJ or 3MF, or of a node of a glTF.
  std::string group = {};   ///< Name of a group of an OBJ.
  bool operator==(const MeshPart&) const = default;
};

struct GltfMaterials;  // Not for users.

/// Attributes of a mesh: what its file says beside positions and triangles. Arrays for each triangle may be
/// empty: none has any.
struct MeshAttributes {
  static constexpr uint32_t kNone = UINT32_MAX;

  std::vector<MeshPart> parts = {};                   ///< Parts of the mesh.
  std::vector<uint32_t> partOf = {};                  ///< Part of each triangle, or `kNone`.
  std::vector<std::string> materials = {};            ///< Names of materials.
  std::vector<uint32_t> materialOf = {};              ///< Material of each triangle, or `kNone`.
  std::vector<std::filesystem::path> libraries = {};  ///< Files that describe the materials.
  std::shared_ptr<const GltfMaterials> gltf = {};     ///< Looks of `materials`, as a glTF has them.
  CornerValues<glm::vec2> uvs = {};                   ///< Texture coordinates; (0, 0) is bottom left.
  CornerValues<glm::vec4> colours = {};               ///< Red, green, blue (sRGB) and alpha, from 0 to 1.
  /// Attributes of the file that no array holds, in words: "3 materials".
  std::vector<std::string> lost = {};
};

/// Returns the attributes of a mesh that was made of a given one. `sources` has the given triangle that each
/// triangle is a part of, or `kNone`; if empty, all attributes are lost. A corner at a given one keeps its
/// values; others are interpolated in the triangle. Throws `Error(Usage)` if sizes or indices do not fit.
RAYMAP_API MeshAttributes carryAttributes(const MeshAttributes& attributes, const MeshView& given,
                                          const MeshView& result, std::span<const uint32_t> sources);

}  // namespace raymap
