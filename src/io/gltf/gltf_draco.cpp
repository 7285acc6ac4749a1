// KHR_draco_mesh_compression.

#include "io/gltf/gltf_draco.h"

#include <raymap/error.h>

#ifdef RAYMAP_DRACO
#include "io/import/import_draco.h"
#endif

namespace raymap {

namespace {

using Json = GltfDocument::Json;

const Json* compressedPart(const Json& primitive) {
  return extensionOf(primitive, "KHR_draco_mesh_compression");
}

bool hasView(const GltfDocument& document, const Json& object, const char* accessor) {
  return document.element("accessors", document.number(object, accessor)).contains("bufferView");
}

#ifdef RAYMAP_DRACO

/// Returns the names of the compressed attributes that are read, with their numbers.
std::map<std::string, uint32_t> numbersOfAttributes(const MeshFile& file, const GltfDocument& document,
                                                    const Json& compressed, const Json& primitive) {
  const auto attributes = compressed.find("attributes");
  if (attributes == compressed.end() || !attributes->is_object() || !attributes->contains("POSITION"))
    file.fail("the KHR_draco_mesh_compression of a primitive has no attribute POSITION");
  std::map<std::string, uint32_t> numbers;
  for (const auto& [name, value] : attributes->items())
    if ((name == "POSITION" || name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_") ||
         (file.attributes && (name == "TEXCOORD_0" || name == "COLOR_0"))) &&
        primitive["attributes"].contains(name))
      numbers[name] = static_cast<uint32_t>(document.number(*attributes, name.c_str()));
  return numbers;
}

DracoSurface surfaceOf(DracoMesh mesh, const std::map<std::string, uint32_t>& attributes) {
  DracoSurface surface{.vertices = mesh.vertices, .triangles = std::move(mesh.triangles)};
  size_t a = 0;
  for (const auto& [name, number] : attributes) {
    surface.attributes[name] = {mesh.attributes[a].components, std::move(mesh.attributes[a].numbers)};
    ++a;
  }
  return surface;
}

#endif

}  // namespace

bool needsDraco(const GltfDocument& document, const Json& primitive) {
  return compressedPart(primitive) &&
         !(hasView(document, primitive["attributes"], "POSITION") &&
           (!primitive.contains("indices") || hasView(document, primitive, "indices")));
}

std::map<const Json*, DracoSurface> decodeDraco(const MeshFile& file,
                                                [[maybe_unused]] const GltfDocument& document,
                                                std::span<const Json* const> surfaces) {
  std::map<const Json*, DracoSurface> decoded;
  if (surfaces.empty()) return decoded;
#ifdef RAYMAP_DRACO
  std::vector<DracoRequest> requests;
  std::vector<std::map<std::string, uint32_t>> attributes;
  uint64_t bytes = 0;
  for (const Json* surface : surfaces) {
    const Json& compressed = *compressedPart(*surface);
    uint64_t stride = 0;
    attributes.push_back(numbersOfAttributes(file, document, compressed, *surface));
    DracoRequest& request = requests.emplace_back();
    request.bytes = document.bufferView(document.number(compressed, "bufferView"), stride);
    for (const auto& [name, number] : attributes.back()) request.attributes.push_back(number);
    bytes += request.bytes.size();
    if (bytes > document.bytes()) file.fail("its primitives share Draco data, which must not be");
  }
  std::vector<DracoMesh> meshes = importDraco(file, requests, document.bytes());
  for (size_t i = 0; i < surfaces.size(); ++i)
    decoded[surfaces[i]] = surfaceOf(std::move(meshes[i]), attributes[i]);
  return decoded;
#else
  throw Error(ErrorCode::Unsupported,
              file.path.string() + ": raymap was built without Draco; build it with RAYMAP_DRACO=ON");
#endif
}

}  // namespace raymap
