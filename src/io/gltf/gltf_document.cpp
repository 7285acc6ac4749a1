#include "io/gltf/gltf_document.h"

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "base/text.h"

namespace raymap {

namespace {

// Upper bound of counts and indices. Sums of two of them, and products with an element's size, fit 64 bits.
constexpr uint64_t kLargest = uint64_t{1} << 48;

constexpr int kDeepest = 256;  // Nesting of JSON: functions of its library call themselves.

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

double loadNumber(const std::byte* bytes, uint64_t type) {
  switch (type) {
    case kInt8:
      return load<int8_t>(bytes);
    case kUInt8:
      return load<uint8_t>(bytes);
    case kInt16:
      return load<int16_t>(bytes);
    case kUInt16:
      return load<uint16_t>(bytes);
    case kUInt32:
      return load<uint32_t>(bytes);
    default:
      return load<float>(bytes);
  }
}

/// Returns the number of a type that stands for 1 if numbers are normalized.
double largestOf(uint64_t type) {
  switch (type) {
    case kInt8:
      return std::numeric_limits<int8_t>::max();
    case kUInt8:
      return std::numeric_limits<uint8_t>::max();
    case kInt16:
      return std::numeric_limits<int16_t>::max();
    case kUInt16:
      return std::numeric_limits<uint16_t>::max();
    case kUInt32:
      return std::numeric_limits<uint32_t>::max();
    default:
      return 1.0;
  }
}

double scaled(double stored, uint64_t type, bool normalized) {
  return normalized && type != kFloat ? std::max(stored / largestOf(type), -1.0) : stored;
}

double loadReal(const std::byte* bytes, uint64_t type, bool normalized) {
  return scaled(loadNumber(bytes, type), type, normalized);
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
  constexpr std::string_view kRead = "; last read: '";
  const size_t read = message.find(kRead), begin = read + kRead.size();
  if (read == message.npos) return std::string(message);
  const size_t end = message.rfind('\'');
  return std::string(message.substr(0, begin - 1)) + excerpt(message.substr(begin, end - begin)) +
         std::string(message.substr(end + 1));
}

std::string jsonText(const GltfDocument::Json& json) {
  return shortText(json.dump(-1, ' ', false, GltfDocument::Json::error_handler_t::replace));
}

}  // namespace

const GltfDocument::Json* extensionOf(const GltfDocument::Json& object, const char* name) {
  const auto all = object.find("extensions");
  if (all == object.end() || !all->is_object()) return nullptr;
  const auto found = all->find(name);
  return found != all->end() && found->is_object() ? &*found : nullptr;
}

std::vector<glm::dvec3> vectors(std::span<const double> numbers) {
  std::vector<glm::dvec3> result;
  result.reserve(numbers.size() / 3);
  for (size_t i = 0; i < numbers.size(); i += 3)
    result.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  return result;
}

GltfDocument::GltfDocument(const MeshFile& file) : file_(file) {
  if (file.text().starts_with("glTF"))
    openBinary();
  else
    parse(file.text());
  openBuffers();
}

void GltfDocument::parse(std::string_view json) {
  try {
    root_ = Json::parse(json, [&](int depth, Json::parse_event_t, const Json&) {
      if (depth > kDeepest) file_.fail("its JSON is nested too deep");
      return true;
    });
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
    file_.fail(std::string("'") + key + "' is not a count or index: " + jsonText(*found));
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
      file_.fail(name + ": '" + key + "' holds " + jsonText(value) + ", which is no number");
    result.push_back(value.get<double>());
  }
  return result;
}

uint64_t GltfDocument::accessorCount(uint64_t accessor) const {
  const Json& json = element("accessors", accessor);
  const std::string what = "accessors[" + std::to_string(accessor) + "]";
  const uint64_t count = number(json, "count");
  if (json.contains("bufferView")) {
    const uint64_t room = viewBytes(number(json, "bufferView"));
    if (count > room)
      file_.fail(what + " has " + counted(count, "element") + ", beyond its bufferView of " +
                 counted(room, "byte"));
  } else {
    checkExpansion(file_, count * sizeof(glm::dvec3), bytes());  // All but the sparse values are 0.
  }
  return count;
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
  static constexpr std::array<std::byte, 16 * sizeof(float)> kZeros{};
  if (!json.contains("bufferView") && !json.contains("sparse")) file_.fail(what + " has no bufferView");
  const uint64_t count = accessorCount(accessor);
  const View base =
      json.contains("bufferView") ? view(json, count, elementBytes, what) : View{kZeros.data(), 0, count};
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

double GltfDocument::real(uint64_t accessor, double stored) const {
  const Json& json = element("accessors", accessor);
  const auto normalized = json.find("normalized");
  return scaled(stored, number(json, "componentType"), normalized != json.end() && *normalized == true);
}

std::vector<glm::dvec3> GltfDocument::offsets(uint64_t accessor, size_t count) const {
  const Json& json = element("accessors", accessor);
  const std::string what = "accessors[" + std::to_string(accessor) + "]";
  if (number(json, "count") != count)
    file_.fail(what + " holds the offsets of " + counted(number(json, "count"), "vertex") +
               " of a morph target, POSITION has " + std::to_string(count));
  if (json.contains("bufferView") || json.contains("sparse")) return vectors(reals(accessor, "VEC3", 3));
  component(json, "VEC3", what);
  return std::vector<glm::dvec3>(count, glm::dvec3(0.0));
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
