#include "io/gltf/gltf_document.h"

#include <raymap/error.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "io/gltf/gltf_uri.h"

namespace raymap {

namespace {

// Upper bound of counts and indices. Sums of two of them, and products with an element's size, fit 64 bits.
constexpr uint64_t kLargest = uint64_t{1} << 48;

// Component types, numbered as in the file.
constexpr uint64_t kInt8 = 5120, kUInt8 = 5121, kInt16 = 5122, kUInt16 = 5123, kUInt32 = 5125, kFloat = 5126;

uint64_t componentBytes(uint64_t type) {
  switch (type) {
    case kInt8:
    case kUInt8:
      return 1;
    case kInt16:
    case kUInt16:
      return 2;
    case kUInt32:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

template <class T>
T load(const std::byte* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

template <class T>
double scaled(const std::byte* bytes, bool normalized) {
  const double value = load<T>(bytes);
  return normalized ? std::max(value / std::numeric_limits<T>::max(), -1.0) : value;
}

double loadReal(const std::byte* bytes, uint64_t type, bool normalized) {
  switch (type) {
    case kInt8:
      return scaled<int8_t>(bytes, normalized);
    case kUInt8:
      return scaled<uint8_t>(bytes, normalized);
    case kInt16:
      return scaled<int16_t>(bytes, normalized);
    case kUInt16:
      return scaled<uint16_t>(bytes, normalized);
    case kUInt32:
      return scaled<uint32_t>(bytes, normalized);
    default:
      return load<float>(bytes);
  }
}

uint32_t loadIndex(const std::byte* bytes, uint64_t type) {
  if (type == kUInt8) return load<uint8_t>(bytes);
  if (type == kUInt16) return load<uint16_t>(bytes);
  return load<uint32_t>(bytes);
}

/// Returns a message of the JSON library without its code. It says where the text is wrong, and how.
std::string inPlainWords(std::string_view message) {
  if (const size_t code = message.find("] "); message.starts_with("[json.") && code != message.npos)
    message.remove_prefix(code + 2);
  constexpr std::string_view kParseError = "parse error at ";
  if (message.starts_with(kParseError)) message.remove_prefix(kParseError.size());
  return std::string(message);
}

std::string shortText(const GltfDocument::Json& json) {
  return json.dump(-1, ' ', false, GltfDocument::Json::error_handler_t::replace).substr(0, 40);
}

}  // namespace

GltfDocument::GltfDocument(const MeshFile& file) : file_(file) {
  if (file.text().starts_with("glTF"))
    openBinary();
  else
    parse(file.text());
  openBuffers();
}

void GltfDocument::parse(std::string_view json) {
  try {
    root_ = Json::parse(json);
  } catch (const Json::exception& error) {
    file_.fail("no valid JSON: " + inPlainWords(error.what()));
  }
  if (!root_.is_object()) file_.fail("not a glTF file: its JSON is not an object");
}

/// Opens a GLB: a 12-byte header, then chunks of (length, type, data), first JSON, then perhaps BIN.
void GltfDocument::openBinary() {
  constexpr size_t kHeader = 12, kChunkHeader = 8;
  constexpr uint32_t kJson = 0x4e4f534a, kBin = 0x004e4942;
  if (file_.bytes.size() < kHeader + kChunkHeader) file_.fail("the GLB file ends within its header");
  if (const auto version = load<uint32_t>(file_.bytes.data() + 4); version != 2)
    throw Error(ErrorCode::Unsupported,
                file_.path.string() + ": glTF version " + std::to_string(version) + "; only 2 is known");
  std::string_view json;
  for (size_t at = kHeader; at + kChunkHeader <= file_.bytes.size();) {
    const uint64_t length = load<uint32_t>(file_.bytes.data() + at);
    const auto type = load<uint32_t>(file_.bytes.data() + at + 4);
    at += kChunkHeader;
    if (length > file_.bytes.size() - at)
      file_.fail("a GLB chunk announces " + counted(length, "byte") + ", but only " +
                 std::to_string(file_.bytes.size() - at) + " follow: the file is cut short");
    if (type == kJson && json.empty()) json = file_.text().substr(at, length);
    if (type == kBin && binaryChunk_.empty()) binaryChunk_ = file_.bytes.subspan(at, length);
    at += length;
  }
  if (json.empty()) file_.fail("the GLB file has no JSON chunk");
  parse(json);
}

void GltfDocument::openBuffers() {
  for (uint64_t b = 0; b < size("buffers"); ++b) {
    const Json& buffer = element("buffers", b);
    const auto uri = buffer.find("uri");
    if (uri == buffer.end()) {
      buffers_.push_back(b == 0 ? binaryChunk_ : std::span<const std::byte>());
    } else if (!uri->is_string()) {
      file_.fail("the uri of buffer " + std::to_string(b) + " is not a string");
    } else {
      openExternal(uri->get_ref<const std::string&>());
    }
    const uint64_t announced = number(buffer, "byteLength");
    if (announced > buffers_.back().size())
      file_.fail("buffer " + std::to_string(b) + " announces " + counted(announced, "byte") + ", but has " +
                 std::to_string(buffers_.back().size()));
  }
}

void GltfDocument::openExternal(const std::string& uri) {
  owned_.push_back(isDataUri(uri) ? decodeDataUri(file_, uri)
                                  : loadFile(SourceFile(relativeFile(file_, uri))));
  buffers_.emplace_back(owned_.back());
}

uint64_t GltfDocument::size(const char* array) const {
  const auto found = root_.find(array);
  if (found == root_.end()) return 0;
  if (!found->is_array()) file_.fail(std::string("'") + array + "' is not a list");
  return found->size();
}

const GltfDocument::Json& GltfDocument::element(const char* array, uint64_t index) const {
  if (index >= size(array))
    file_.fail(std::string(array) + "[" + std::to_string(index) + "] does not exist: the file has " +
               std::to_string(size(array)));
  const Json& found = root_[array][index];
  if (!found.is_object()) file_.fail(std::string(array) + "[" + std::to_string(index) + "] is not an object");
  return found;
}

uint64_t GltfDocument::number(const Json& object, const char* key) const {
  const auto found = object.find(key);
  if (found == object.end()) file_.fail(std::string("'") + key + "' is missing");
  if (!found->is_number_unsigned() || found->get<uint64_t>() >= kLargest)
    file_.fail(std::string("'") + key + "' is not a count or index: " + shortText(*found));
  return found->get<uint64_t>();
}

uint64_t GltfDocument::number(const Json& object, const char* key, uint64_t missing) const {
  return object.contains(key) ? number(object, key) : missing;
}

std::vector<uint64_t> GltfDocument::indices(const Json& object, const char* key) const {
  std::vector<uint64_t> result;
  const auto found = object.find(key);
  if (found == object.end()) return result;
  if (!found->is_array()) file_.fail(std::string("'") + key + "' is not a list");
  for (const Json& index : *found) {
    if (!index.is_number_unsigned())
      file_.fail(std::string("'") + key + "' holds something that is not an index");
    result.push_back(index.get<uint64_t>());
  }
  return result;
}

std::vector<double> GltfDocument::numbers(const Json& object, const std::string& name, const char* key,
                                          size_t count) const {
  std::vector<double> result;
  const auto found = object.find(key);
  if (found == object.end()) return result;
  if (!found->is_array() || found->size() != count)
    file_.fail(name + ": '" + key + "' is not a list of " + std::to_string(count) + " numbers");
  for (const Json& value : *found) {
    if (!value.is_number())
      file_.fail(name + ": '" + key + "' holds " + shortText(value) + ", which is no number");
    result.push_back(value.get<double>());
  }
  return result;
}

uint64_t GltfDocument::accessorCount(uint64_t accessor) const {
  const Json& json = element("accessors", accessor);
  const std::string what = "accessors[" + std::to_string(accessor) + "]";
  if (!json.contains("bufferView")) file_.fail(what + " has no bufferView");
  uint64_t stride = 0;
  const uint64_t count = number(json, "count"), room = bufferView(number(json, "bufferView"), stride).size();
  if (count > room)
    file_.fail(what + " has " + counted(count, "element") + ", beyond its bufferView of " +
               counted(room, "byte"));
  return count;
}

std::span<const std::byte> GltfDocument::bufferView(uint64_t index, uint64_t& stride) const {
  const Json& view = element("bufferViews", index);
  const uint64_t buffer = number(view, "buffer");
  element("buffers", buffer);
  const uint64_t offset = number(view, "byteOffset", 0), length = number(view, "byteLength");
  if (offset + length > buffers_[buffer].size())
    file_.fail("bufferViews[" + std::to_string(index) + "] covers bytes " + std::to_string(offset) + " to " +
               std::to_string(offset + length) + " of a buffer of " +
               std::to_string(buffers_[buffer].size()));
  stride = number(view, "byteStride", stride);
  return buffers_[buffer].subspan(offset, length);
}

GltfDocument::View GltfDocument::view(const Json& at, uint64_t count, uint64_t elementBytes,
                                      const std::string& what) const {
  View result{nullptr, elementBytes, count};
  const std::span<const std::byte> bytes = bufferView(number(at, "bufferView"), result.stride);
  const uint64_t offset = number(at, "byteOffset", 0);
  // This form cannot overflow: the division gives the number of elements that fit after the first.
  const bool fits = count == 0 || (result.stride > 0 && offset + elementBytes <= bytes.size() &&
                                   count - 1 <= (bytes.size() - offset - elementBytes) / result.stride);
  if (!fits)
    file_.fail(what + " has " + counted(count, "element") + " of " + counted(elementBytes, "byte") +
               " from byte " + std::to_string(offset) + ", beyond its bufferView of " +
               counted(bytes.size(), "byte"));
  result.data = bytes.data() + (count == 0 ? 0 : offset);
  return result;
}

template <class Put>
void GltfDocument::readAccessor(uint64_t accessor, uint64_t elementBytes, Put put) const {
  const Json& json = element("accessors", accessor);
  const std::string what = "accessors[" + std::to_string(accessor) + "]";
  const View base = view(json, accessorCount(accessor), elementBytes, what);
  for (uint64_t i = 0; i < base.count; ++i) put(i, base.data + i * base.stride);
  if (const auto sparse = json.find("sparse"); sparse != json.end()) {
    if (!sparse->is_object()) file_.fail(what + ": 'sparse' is not an object");
    readSparse(*sparse, base.count, elementBytes, what, put);
  }
}

template <class Put>
void GltfDocument::readSparse(const Json& sparse, uint64_t count, uint64_t elementBytes,
                              const std::string& what, Put put) const {
  const auto indices = sparse.find("indices"), values = sparse.find("values");
  if (indices == sparse.end() || values == sparse.end() || !indices->is_object() || !values->is_object())
    file_.fail(what + ": 'sparse' lacks its indices or values");
  const uint64_t type = number(*indices, "componentType"), changed = number(sparse, "count");
  if (type != kUInt8 && type != kUInt16 && type != kUInt32)
    file_.fail(what + ": sparse indices have componentType " + std::to_string(type));
  const View at = view(*indices, changed, componentBytes(type), what + ".sparse.indices");
  const View value = view(*values, changed, elementBytes, what + ".sparse.values");
  for (uint64_t i = 0; i < changed; ++i) {
    const uint32_t index = loadIndex(at.data + i * at.stride, type);
    if (index >= count)
      file_.fail(what + ": sparse index " + std::to_string(index) + " is out of range (" +
                 counted(count, "element") + ")");
    put(index, value.data + i * value.stride);
  }
}

GltfDocument::Component GltfDocument::component(const Json& accessor, const char* type,
                                                const std::string& what) const {
  const auto given = accessor.find("type");
  if (given == accessor.end() || *given != type) file_.fail(what + " should have type " + type);
  Component result{number(accessor, "componentType"), false};
  if (componentBytes(result.type) == 0)
    file_.fail(what + " has unknown componentType " + std::to_string(result.type));
  if (const auto normalized = accessor.find("normalized"); normalized != accessor.end())
    result.normalized = *normalized == true;
  return result;
}

std::vector<double> GltfDocument::reals(uint64_t accessor, const char* type, uint64_t components) const {
  const std::string what = "accessors[" + std::to_string(accessor) + "]";
  const Component part = component(element("accessors", accessor), type, what);
  const uint64_t bytes = componentBytes(part.type);
  std::vector<double> result;
  readAccessor(accessor, components * bytes, [&](uint64_t i, const std::byte* at) {
    if (i * components == result.size()) result.resize(result.size() + components);
    for (uint64_t c = 0; c < components; ++c)
      result[i * components + c] = loadReal(at + c * bytes, part.type, part.normalized);
  });
  return result;
}

std::vector<glm::dvec3> GltfDocument::positions(uint64_t accessor) const {
  const std::vector<double> numbers = reals(accessor, "VEC3", 3);
  std::vector<glm::dvec3> result;
  result.reserve(numbers.size() / 3);
  for (size_t i = 0; i < numbers.size(); i += 3)
    result.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  return result;
}

std::vector<glm::dvec3> GltfDocument::offsets(uint64_t accessor, size_t count) const {
  const Json& json = element("accessors", accessor);
  const std::string what = "accessors[" + std::to_string(accessor) + "]";
  if (number(json, "count") != count)
    file_.fail(what + " holds the offsets of " + counted(number(json, "count"), "vertex") +
               " of a morph target, POSITION has " + std::to_string(count));
  if (json.contains("bufferView")) return positions(accessor);
  std::vector<glm::dvec3> result(count, glm::dvec3(0.0));
  const Component part = component(json, "VEC3", what);
  const uint64_t bytes = componentBytes(part.type);
  if (const auto sparse = json.find("sparse"); sparse != json.end()) {
    if (!sparse->is_object()) file_.fail(what + ": 'sparse' is not an object");
    readSparse(*sparse, count, 3 * bytes, what, [&](uint64_t i, const std::byte* at) {
      for (uint64_t c = 0; c < 3; ++c)
        result[i][static_cast<int>(c)] = loadReal(at + c * bytes, part.type, part.normalized);
    });
  }
  return result;
}

std::vector<uint32_t> GltfDocument::vertexIndices(uint64_t accessor) const {
  const std::string what = "accessors[" + std::to_string(accessor) + "]";
  const uint64_t type = component(element("accessors", accessor), "SCALAR", what).type;
  if (type != kUInt8 && type != kUInt16 && type != kUInt32)
    file_.fail(what + " holds indices of componentType " + std::to_string(type));
  std::vector<uint32_t> result;
  readAccessor(accessor, componentBytes(type), [&](uint64_t i, const std::byte* at) {
    if (i == result.size()) result.emplace_back();
    result[i] = loadIndex(at, type);
  });
  return result;
}

}  // namespace raymap
