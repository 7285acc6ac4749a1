#include "io/mesh/gltf_materials.h"

#include <raymap/error.h>

#include <algorithm>
#include <set>

#include "io/gltf/gltf_document.h"
#include "io/gltf/gltf_uri.h"

namespace raymap {

namespace {

using Json = GltfDocument::Json;

/// Returns whether something is a reference to a texture with other coordinates than the first ones.
bool usesOtherCoordinates(const Json& json) {
  if (!json.is_object() || !json.contains("index")) return false;
  const Json* moved = extensionOf(json, "KHR_texture_transform");
  return (moved && moved->contains("texCoord") ? *moved : json).value("texCoord", Json(0)) != 0;
}

class MaterialReader {
 public:
  MaterialReader(const MeshFile& file, const GltfDocument& document) : file_(file), document_(document) {}

  GltfMaterials read(std::vector<std::string>& lost) {
    for (const char* array : {"materials", "textures", "samplers", "images"})
      for (uint64_t i = 0; i < document_.size(array); ++i) {
        Json& json = found_.root[array].emplace_back(document_.element(array, i));
        prune(json);
        if (array == std::string_view("images")) store(json);
      }
    for (const char* array : {"extensionsUsed", "extensionsRequired"})
      if (const auto names = document_.root().find(array); names != document_.root().end())
        for (const Json& name : *names)
          if (name.is_string() && used_.contains(name.get<std::string>())) found_.root[array].push_back(name);
    if (dropped_ > 0) lost.push_back(counted(dropped_, "texture") + " with other coordinates");
    return std::move(found_);
  }

 private:
  /// Drops references to textures whose coordinates are not read. Collects the names of extensions.
  void prune(Json& json) {
    if (const auto all = json.is_object() ? json.find("extensions") : json.end(); all != json.end())
      for (const auto& [name, extension] : all->items()) used_.insert(name);
    if (json.is_object())
      dropped_ += std::erase_if(json.get_ref<Json::object_t&>(),
                                [](const auto& member) { return usesOtherCoordinates(member.second); });
    if (json.is_structured())
      for (Json& child : json) prune(child);
  }

  void store(Json& image) {
    Buffer<std::byte> bytes;
    if (image.contains("bufferView")) {
      uint64_t stride = 0;
      const std::span<const std::byte> view =
          document_.bufferView(document_.number(image, "bufferView"), stride);
      if ((copied_ += view.size()) > document_.bytes()) file_.fail("its images share most of their bytes");
      bytes.resizeUninitialized(view.size());
      std::ranges::copy(view, bytes.begin());
    } else if (!load(image, bytes)) {
      return;
    }
    const int first = bytes.empty() ? 0 : std::to_integer<int>(bytes[0]);  // It tells the types apart.
    const char* type = first == 0x89 ? "png" : first == 0xff ? "jpeg" : first == 0xab ? "ktx2" : "webp";
    if (!image.contains("mimeType")) image["mimeType"] = std::string("image/") + type;
    image["bufferView"] = found_.images.size();
    found_.images.push_back(std::move(bytes));
  }

  /// Loads an image in another file, or in text. One that cannot be read stays a name.
  bool load(Json& image, Buffer<std::byte>& bytes) {
    const auto uri = image.find("uri");
    if (uri == image.end() || !uri->is_string()) return false;
    try {
      bytes = loadUri(file_, uri->get_ref<const std::string&>());
      checkMemory(file_, loaded_ += bytes.size());
      image.erase(uri);
      return true;
    } catch (const Error& error) {
      if (error.code() == ErrorCode::Memory) throw;
      if (++missing_ == 1) file_.warnThat("an image is named but not embedded: " + std::string(error.what()));
      return false;
    }
  }

  const MeshFile& file_;
  const GltfDocument& document_;
  GltfMaterials found_;
  std::set<std::string> used_;  ///< Names of extensions.
  uint64_t copied_ = 0, loaded_ = 0, missing_ = 0, dropped_ = 0;
};

}  // namespace

std::shared_ptr<const GltfMaterials> readMaterials(const MeshFile& file, const GltfDocument& document,
                                                   std::vector<std::string>& lost) {
  return std::make_shared<const GltfMaterials>(MaterialReader(file, document).read(lost));
}

}  // namespace raymap
