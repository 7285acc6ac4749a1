#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/3mf/model_part.h"
#include "io/mesh/gltf_materials.h"
#include "mesh/attribute_words.h"

namespace raymap {

/// Makes the attributes of a mesh from the properties of triangles, of which the objects are appended in
/// turn.
class PropertyReader {
 public:
  explicit PropertyReader(const MeshFile& file) : file_(file) {}

  /// Appends those of the triangles of an object of a part. A mirrored one has swapped its last corners.
  void append(const ModelPart3mf& part, const Object3mf& object, bool isMirrored);
  /// Stores all of them. Warns of those that are malformed, and are left out.
  void finish();

 private:
  void append(const PropertyGroup3mf& group, const glm::uvec3& indices);
  uint32_t firstOf(const PropertyGroup3mf& group);

  const MeshFile& file_;
  std::map<const PropertyGroup3mf*, uint32_t> firsts_;  ///< Places of groups among all materials or colours.
  std::vector<uint32_t> materialOf_;
  std::vector<glm::uvec3> colours_;
  GltfMaterials looks_;
  size_t malformed_ = 0, others_ = 0;
};

/// Properties of triangles of a 3MF to write: its materials, and its colours rounded to 8 bits.
class PropertyText {
 public:
  /// Groups have the number `firstId` and the next one.
  PropertyText(const MeshAttributes* attributes, size_t firstId);

  /// Returns the elements of the groups.
  std::string groups() const;
  /// Returns the XML attributes of a triangle.
  std::string of(size_t face) const;
  /// Returns those of an object of `count` triangles, all or `faces`: what most of them have. 3MF gives it to
  /// those without a property.
  std::string defaultOf(std::span<const uint32_t> faces, size_t count) const;

 private:
  std::optional<Property3mf> propertyOf(size_t face) const;

  const MeshAttributes* attributes_;
  size_t firstId_;
  std::vector<uint32_t> colours_;  ///< Different ones in use, as 0xRRGGBBAA in rising order.
};

/// Returns in words what a 3MF lacks of materials and colours.
std::vector<std::string> lostIn3mf(const MeshAttributes& attributes);

}  // namespace raymap
