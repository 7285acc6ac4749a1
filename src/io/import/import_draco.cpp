#include "io/import/import_draco.h"

#include "io/import/import_stream.h"
#include "io/import/importer.h"

namespace raymap {

namespace {

template <class T>
void appendBytes(std::vector<std::byte>& out, std::span<const T> values) {
  const std::span<const std::byte> bytes = std::as_bytes(values);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

std::vector<std::byte> packed(std::span<const DracoRequest> requests) {
  std::vector<std::byte> out;
  for (const DracoRequest& each : requests) {
    const DracoHeader header{each.attributes.size(), each.bytes.size()};
    appendBytes(out, std::span(&header, 1));
    appendBytes(out, std::span<const uint32_t>(each.attributes));
    appendBytes(out, each.bytes);
  }
  return out;
}

class Receiver {
 public:
  Receiver(const MeshFile& file, Importer& importer, uint64_t fileBytes)
      : file_(file), importer_(importer), fileBytes_(fileBytes) {}

  DracoMesh mesh(size_t attributes) {
    MeshHeader header;
    importer_.receive(&header, sizeof header);
    DracoMesh mesh{.vertices = checked(header.vertices, 1)};
    mesh.triangles.resize(checked(header.triangles, sizeof(glm::uvec3)));
    importer_.receive(mesh.triangles.data(), mesh.triangles.size() * sizeof(glm::uvec3));
    for (size_t a = 0; a < attributes; ++a) {
      DracoMesh::Attribute& attribute = mesh.attributes.emplace_back();
      importer_.receive(&attribute.components, sizeof attribute.components);
      if (attribute.components > 255) file_.fail("an attribute of its Draco data is no vector");
      attribute.numbers.resize(checked(header.vertices * attribute.components, sizeof(double)));
      importer_.receive(attribute.numbers.data(), attribute.numbers.size() * sizeof(double));
    }
    return mesh;
  }

 private:
  /// Returns a count, unless it makes the sum of all bytes too large.
  uint64_t checked(uint64_t count, size_t elementBytes) {
    constexpr uint64_t kMost = uint64_t{255} << 32;
    if (count > kMost) file_.fail("its Draco data hold more than 2^32 vertices or triangles");
    bytes_ += count * elementBytes;
    checkExpansion(file_, bytes_, fileBytes_);
    return count;
  }

  const MeshFile& file_;
  Importer& importer_;
  uint64_t fileBytes_, bytes_ = 0;
};

}  // namespace

std::vector<DracoMesh> importDraco(const MeshFile& file, std::span<const DracoRequest> requests,
                                   uint64_t fileBytes) {
  const std::vector<std::byte> request = packed(requests);
  constexpr uint64_t kTighter = 4;  // A byte of Draco makes more of a mesh than one of other formats.
  Importer importer(SourceFile(file.path, request), ".drc", kTighter * request.size());
  Receiver receiver(file, importer, fileBytes);
  std::vector<DracoMesh> meshes;
  for (const DracoRequest& each : requests) meshes.push_back(receiver.mesh(each.attributes.size()));
  return meshes;
}

}  // namespace raymap
