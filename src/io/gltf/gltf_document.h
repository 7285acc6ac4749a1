#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace raymap {

/// A glTF 2.0 or GLB file with its buffers; every reference in it is checked when it is followed.
class GltfDocument {
 public:
  using Json = nlohmann::json;

  explicit GltfDocument(const MeshFile& file);

  const Json& root() const { return root_; }
  /// How many elements a top-level array has; 0 if it is missing.
  uint64_t size(const char* array) const;
  /// `array[index]`, an object; fails naming both.
  const Json& element(const char* array, uint64_t index) const;
  /// The elements that a list of indices names; none if the list is missing.
  std::vector<uint64_t> indices(const Json& object, const char* key) const;
  uint64_t number(const Json& object, const char* key) const;
  uint64_t number(const Json& object, const char* key, uint64_t missing) const;
  /// `count` numbers, or none if the key is missing.
  std::vector<double> numbers(const Json& object, const char* key, size_t count) const;

  /// At most the bytes of its bufferView.
  uint64_t accessorCount(uint64_t accessor) const;
  std::vector<glm::dvec3> positions(uint64_t accessor) const;
  /// All numbers of an accessor whose elements are of that type ("VEC4") and have so many.
  std::vector<double> reals(uint64_t accessor, const char* type, uint64_t components) const;
  std::vector<uint32_t> vertexIndices(uint64_t accessor) const;

 private:
  /// Equal steps through a part of a buffer that has been checked.
  struct View {
    const std::byte* data = nullptr;
    uint64_t stride = 0;
    uint64_t count = 0;
  };
  struct Component {
    uint64_t type = 0;
    bool normalized = false;
  };

  void parse(std::string_view json);
  void openBinary();
  void openBuffers();
  void openExternal(const std::string& uri);
  std::span<const std::byte> bufferView(uint64_t index, uint64_t& stride) const;
  View view(const Json& at, uint64_t count, uint64_t elementBytes, const std::string& what) const;
  /// The accessor's values, with its sparse ones put in; `put(element, bytes)` takes them.
  template <class Put>
  void readAccessor(uint64_t accessor, uint64_t elementBytes, Put put) const;
  template <class Put>
  void readSparse(const Json& sparse, uint64_t count, uint64_t elementBytes, const std::string& what,
                  Put put) const;
  Component component(const Json& accessor, const char* type, const std::string& what) const;

  const MeshFile& file_;
  Json root_;
  std::span<const std::byte> binaryChunk_;
  std::vector<std::span<const std::byte>> buffers_;
  std::vector<Buffer<std::byte>> owned_;
};

}  // namespace raymap
