#pragma once

#include <raymap/mesh_attributes.h>

#include <cstdint>
#include <string>
#include <vector>

namespace raymap {

inline constexpr uint32_t kNoAttribute = MeshAttributes::kNone;

/// Kinds of attributes.
struct AttributeKinds {
  bool parts = false, materials = false, uvs = false, colours = false;
};

/// Returns the attributes of these kinds in words, "2 part names", as far as there are any. The name of a
/// single part is none.
std::vector<std::string> describe(const MeshAttributes& attributes, const AttributeKinds& kinds);

/// Throws `Error(Usage)` unless attributes have places for so many triangles, and none is out of range.
void validate(const MeshAttributes& attributes, size_t triangles);

}  // namespace raymap
