// The buffers and bufferViews of a glTF file, and their compression by EXT_meshopt_compression and
// KHR_meshopt_compression.

#include <algorithm>

#include "base/text.h"
#include "io/gltf/gltf_document.h"
#include "io/gltf/gltf_uri.h"
#include "io/gltf/meshopt.h"

namespace raymap {

namespace {

using Json = GltfDocument::Json;

/// Returns the object of a meshopt extension, or null.
const Json* meshoptOf(const Json& json) {
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (const Json* found = extensionOf(json, name)) return found;
  return nullptr;
}

std::string textOf(const Json& json, const char* key, const char* missing) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? found->get<std::string>() : missing;
}

/// Returns whether a buffer only holds, or would hold, what bufferViews have in compressed form too.
bool isFallback(const Json& buffer) {
  const Json* compressed = meshoptOf(buffer);
  return compressed && compressed->contains("fallback") && (*compressed)["fallback"] == true;
}

/// Decodes the bytes of a bufferView. Returns whether they make `out.size() / stride` elements.
bool decodeMeshopt(const std::string& mode, std::span<const std::byte> in, std::span<std::byte> out,
                   size_t stride) {
  const bool isIndex = stride == 2 || stride == 4;
  if (mode == "ATTRIBUTES")
    return stride > 0 && stride <= 256 && stride % 4 == 0 && decodeMeshoptAttributes(in, out, stride);
  if (mode == "TRIANGLES")
    return isIndex && out.size() % (3 * stride) == 0 && decodeMeshoptTriangles(in, out, stride);
  return mode == "INDICES" && isIndex && decodeMeshoptIndices(in, out, stride);
}

}  // namespace

void GltfDocument::openBuffers() {
  for (uint64_t b = 0; b < size("buffers"); ++b) {
    const Json& buffer = element("buffers", b);
    const auto uri = buffer.find("uri");
    if (isFallback(buffer)) {
      buffers_.emplace_back();
      continue;
    }
    if (uri == buffer.end()) {
      buffers_.push_back(b == 0 ? binaryChunk_ : std::span<const std::byte>());
    } else if (!uri->is_string()) {
      file_.fail("the uri of buffer " + std::to_string(b) + " is not a string");
    } else {
      openExternal(uri->get_ref<const std::string&>());
    }
    const uint64_t announced = number(buffer, "byteLength");
    if (announced > buffers_.back().size() && (b == 0 || uri != buffer.end()))
      file_.fail("buffer " + std::to_string(b) + " announces " + counted(announced, "byte") + ", but has " +
                 std::to_string(buffers_.back().size()));
  }
}

void GltfDocument::openExternal(const std::string& uri) {
  owned_.push_back(loadUri(file_, uri));
  buffers_.emplace_back(owned_.back());
}

uint64_t GltfDocument::bytes() const {
  uint64_t sum = file_.bytes.size();
  for (const Buffer<std::byte>& each : owned_) sum += each.size();
  return sum;
}

uint64_t GltfDocument::viewBytes(uint64_t index) const {
  const Json& view = element("bufferViews", index);
  if (!meshoptOf(view)) return bufferBytes(view, index).size();
  return number(view, "byteLength");
}

std::span<const std::byte> GltfDocument::bufferBytes(const Json& view, uint64_t index) const {
  const uint64_t buffer = number(view, "buffer");
  element("buffers", buffer);
  const uint64_t offset = number(view, "byteOffset", 0), length = number(view, "byteLength");
  if (offset + length > buffers_[buffer].size())
    file_.fail("bufferViews[" + std::to_string(index) + "] covers bytes " + std::to_string(offset) + " to " +
               std::to_string(offset + length) + " of a buffer of " +
               std::to_string(buffers_[buffer].size()));
  return buffers_[buffer].subspan(offset, length);
}

std::span<const std::byte> GltfDocument::bufferView(uint64_t index, uint64_t& stride) const {
  const Json& view = element("bufferViews", index);
  stride = number(view, "byteStride", stride);
  const Json* const compressed = meshoptOf(view);
  return compressed ? decoded(index, view, *compressed) : bufferBytes(view, index);
}

std::span<const std::byte> GltfDocument::decoded(uint64_t index, const Json& view,
                                                 const Json& compressed) const {
  if (const auto found = decoded_.find(index); found != decoded_.end()) return found->second;
  const std::string what = "bufferViews[" + std::to_string(index) + "]";
  const uint64_t stride = number(compressed, "byteStride"), count = number(compressed, "count");
  const uint64_t length = number(view, "byteLength");
  if (stride > 256 || stride * count != length)
    file_.fail(what + " of " + counted(length, "byte") + " is compressed from " + counted(count, "element") +
               " of " + counted(stride, "byte"));
  decodedBytes_ += length;
  checkExpansion(file_, decodedBytes_, bytes());
  const std::string mode = textOf(compressed, "mode", ""), filter = textOf(compressed, "filter", "NONE");
  Buffer<std::byte> out(length);
  std::ranges::fill(out, std::byte{0});
  if (!decodeMeshopt(mode, bufferBytes(compressed, index), out, stride))
    file_.fail(what + ": its compressed data (meshopt, mode " + shortText(mode) +
               ") are damaged or cut short");
  if (!undoMeshoptFilter(filter, out, stride))
    file_.fail(what + ": no filter " + excerpt(filter) + " makes positions or indices of " +
               counted(stride, "byte"));
  return decoded_.emplace(index, std::move(out)).first->second;
}

}  // namespace raymap
