#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "io/3mf/zip_parts.h"

namespace raymap {

/// An object at a place: a component of another object, or an item of the build.
struct Placement3mf {
  std::string part;  ///< Which part has the object.
  uint32_t object = 0;
  glm::dmat4x3 transform{1.0};  ///< In millimetres.
  uint64_t line = 0;            ///< Where the part that places it says so.
};

/// Materials or colours that triangles refer to.
struct PropertyGroup3mf {
  enum class Kind : uint8_t { Materials, Colours, Other };
  Kind kind = Kind::Other;
  std::vector<glm::vec4> colours;  ///< In sRGB with alpha, from 0 to 1.
  std::vector<std::string> names;  ///< Those of materials.
};

/// A group's number, `kNoAttribute` for none, and the index in it at each corner.
struct Property3mf {
  uint32_t group = UINT32_MAX;
  glm::uvec3 indices{0};
};

/// Use of a part of an object by a slicer.
enum class PartUse : uint8_t { Print, CutOut, Modify, BlockSupport, EnforceSupport };

/// Numbers of an object's parts, by their use.
using PartCounts = std::array<size_t, 5>;

struct Object3mf {
  std::string type = "model", name;
  std::vector<glm::dvec3> vertices;  ///< In millimetres.
  std::vector<glm::uvec3> triangles;
  Property3mf property = {};            ///< The one for triangles without one of their own.
  std::vector<Property3mf> properties;  ///< One for each triangle, or none; only read if asked for.
  std::vector<Placement3mf> components;
  PartCounts unprinted{};  ///< Parts that a slicer's project does not print.
};

/// Geometry of a model part.
struct ModelPart3mf {
  std::string unit = "millimeter";
  std::map<uint32_t, Object3mf> objects;
  std::vector<Placement3mf> items;
  std::map<uint32_t, PropertyGroup3mf> groups;
  bool isPainted = false;     ///< Whether a slicer paints triangles; only known if asked for.
  size_t unprintedItems = 0;  ///< Number of items with printable="0", which are left out.
};

/// Reads a model part. Fails with the part, the line, the element and the value if it is not valid. Throws
/// `Error(Unsupported)` if it requires an extension that changes shapes.
ModelPart3mf readModelPart(ZipParts& parts, const std::string& name);

/// Returns a part's name as a path of a relationship or a component gives it, without its first slash.
std::string partName(const ZipParts& parts, std::string_view path);

}  // namespace raymap
