#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace raymap {

/// A glTF 2.0 or GLB file with its buffers. References in the file are checked when they are followed.
class GltfDocument {
 public:
  using Json = nlohmann::json;

  explicit GltfDocument(const MeshFile& file);

  const Json& root() const { return root_; }
  /// Returns the number of elements of a top-level array; 0 if it is missing.
  uint64_t size(const char* array) const;
  /// Returns the object `array[index]`. Fails with the array's name and the index if there is none.
  const Json& element(const char* array, uint64_t index) const;
  /// Returns a list of indices; empty if the list is missing.
  std::vector<uint64_t> indices(const Json& object, const char* key) const;
  uint64_t number(const Json& object, const char* key) const;
  uint64_t number(const Json& object, const char* key, uint64_t missing) const;
  /// Returns `count` numbers of an object named `name`, or none if the key is missing.
  std::vector<double> numbers(const Json& object, const std::string& name, const char* key,
                              size_t count) const;

  /// Returns the number of bytes of the file and the buffers that it refers to.
  uint64_t bytes() const;
  /// Returns the bytes of a bufferView, decoded if they are compressed. Sets `stride` if the view has one.
  std::span<const std::byte> bufferView(uint64_t index, uint64_t& stride) const;
  /// Returns the number of elements, at most the number of bytes of the accessor's bufferView. Without one,
  /// the elements are 0, or another part of the file has them.
  uint64_t accessorCount(uint64_t accessor) const;
  /// Returns the offsets of `count` vertices. Without a bufferView and sparse values they are 0.
  std::vector<glm::dvec3> offsets(uint64_t accessor, size_t count) const;
  /// Returns all numbers of an accessor whose elements have the type `type` ("VEC4") with `components`
  /// numbers.
  std::vector<double> reals(uint64_t accessor, const char* type, uint64_t components) const;
  std::vector<uint32_t> vertexIndices(uint64_t accessor) const;
  /// Returns what an accessor makes of a number in its data: itself, unless the accessor normalizes.
  double real(uint64_t accessor, double stored) const;

 private:
  /// A part of a buffer, read in equal steps. Its bounds have been checked.
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
  std::span<const std::byte> decoded(uint64_t index, const Json& view, const Json& compressed) const;
  std::span<const std::byte> bufferBytes(const Json& view, uint64_t index) const;
  /// Returns the size of a bufferView, decoded if it is compressed.
  uint64_t viewBytes(uint64_t index) const;
  View view(const Json& at, uint64_t count, uint64_t elementBytes, const std::string& what) const;
  /// Calls `put(element, bytes)` for each value of the accessor, then for each sparse value, which replaces
  /// it.
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
  mutable std::map<uint64_t, Buffer<std::byte>> decoded_;  ///< By the bufferView.
  mutable uint64_t decodedBytes_ = 0;
};

/// Returns an extension of an object, or null.
const GltfDocument::Json* extensionOf(const GltfDocument::Json& object, const char* name);

/// Reads all materials of a file. Fails if the file lacks one of their images. Adds to `lost` what is left
/// out. An image in another file that cannot be read stays a name, with a warning.
std::shared_ptr<const GltfMaterials> readMaterials(const MeshFile& file, const GltfDocument& document,
                                                   std::vector<std::string>& lost);

/// Returns each three numbers as a vector.
std::vector<glm::dvec3> vectors(std::span<const double> numbers);

}  // namespace raymap
