#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace raymap {

enum class PlyFormat { Text, LittleEndian, BigEndian };
enum class PlyType { Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Float, Double };

size_t plyTypeBytes(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::Float;
  bool isList = false;
  PlyType countType = PlyType::UInt8;
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Returns the index of a property, or -1.
  int find(std::string_view property) const;
  /// Returns the index of a coordinate, 0 to 2, or -1. Its name is x, y or z, or a capital.
  int findCoordinate(int axis) const;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::Text;
  std::vector<PlyElement> elements;
  size_t bytes = 0;  ///< Size of the header, after which the data begins.

  /// Returns null if there is none.
  const PlyElement* find(std::string_view element) const;
};

/// Reads the header. Throws `Error(Input)` if the file is too small for an element's count.
PlyHeader readPlyHeader(const MeshFile& file);

}  // namespace raymap
