// NumPy's .npy: a magic number, a header that is a Python dictionary, the array.

#include "io/field/npy.h"

#include <charconv>
#include <map>
#include <ostream>

#include "base/text.h"
#include "io/field/field_formats.h"

namespace raymap {

namespace {

constexpr std::string_view kMagic = "\x93NUMPY";

/// Returns the text from the key's value in the dictionary to the end.
std::string_view valueAfter(const std::filesystem::path& path, std::string_view text, std::string_view key) {
  size_t at = text.find("'" + std::string(key) + "'");
  if (at != std::string_view::npos) at = text.find(':', at);
  if (at != std::string_view::npos) at = text.find_first_not_of(' ', at + 1);
  if (at == std::string_view::npos) throwInvalid(path, "its NumPy header has no '" + std::string(key) + "'");
  return text.substr(at);
}

std::vector<int64_t> parseShape(const std::filesystem::path& path, std::string_view text) {
  constexpr size_t kMostAxes = 32;  // NumPy's own limit.
  const size_t end = text.find(')');
  if (text.empty() || text[0] != '(' || end == std::string_view::npos)
    throwInvalid(path, "its NumPy header has no valid shape");
  std::vector<int64_t> shape;
  for (const char *at = text.data() + 1, *last = text.data() + end; at != last && shape.size() < kMostAxes;) {
    if (*at == ' ' || *at == ',') {
      ++at;
      continue;
    }
    int64_t side = 0;
    const auto [next, error] = std::from_chars(at, last, side);
    if (error != std::errc()) throwInvalid(path, "its NumPy header has no valid shape");
    shape.push_back(side);
    at = next;
  }
  return shape;
}

/// Returns a shape as Python writes a tuple: (), (3,), (3, 4).
std::string tuple(const std::vector<int64_t>& shape) {
  std::string text = "(";
  for (size_t axis = 0; axis < shape.size(); ++axis)
    text += (axis > 0 ? ", " : "") + std::to_string(shape[axis]);
  return text + (shape.size() == 1 ? ",)" : ")");
}

}  // namespace

ArrayLayout layoutOf(const std::filesystem::path& path, const NpyHeader& header) {
  static const std::map<std::string, ElementType, std::less<>> kTypes{{"f2", ElementType::Float16},
                                                                      {"f4", ElementType::Float32},
                                                                      {"f8", ElementType::Float64},
                                                                      {"u4", ElementType::UInt32},
                                                                      {"i4", ElementType::Int32}};
  const auto found = header.type.empty() ? kTypes.end() : kTypes.find(header.type.substr(1));
  if (found == kTypes.end())
    throwUnsupported(path, "elements of NumPy type " + excerpt(header.type) + "; save it as float32");
  return {found->second, header.type[0] == '>', !header.xFastest};
}

NpyHeader readNpyHeader(const std::filesystem::path& path, const ReadBytes& read) {
  constexpr uint32_t kLongestHeader = 1 << 16;
  std::array<unsigned char, 8> start{};
  read(start.data(), start.size());
  if (std::string_view(reinterpret_cast<const char*>(start.data()), kMagic.size()) != kMagic)
    throwInvalid(path, "does not begin as a NumPy array");
  std::array<unsigned char, 4> lengthBytes{};
  read(lengthBytes.data(), start[6] == 1 ? 2 : 4);
  uint32_t length = 0;
  for (size_t i = 0; i < 4; ++i) length |= uint32_t{lengthBytes[i]} << (8 * i);
  if (length > kLongestHeader) throwInvalid(path, "its NumPy header is too long");
  std::string text(length, ' ');
  read(text.data(), text.size());
  if (start[6] > 3 || !text.starts_with('{')) throwInvalid(path, "its NumPy header is not valid");

  NpyHeader header;
  const std::string_view type = valueAfter(path, text, "descr");
  const size_t quote = type.find(type[0], 1);
  if (type[0] != '\'' || quote == std::string_view::npos)
    throwUnsupported(path, "a NumPy array of records; save plain numbers");
  header.type = type.substr(1, quote - 1);
  const std::string_view order = valueAfter(path, text, "fortran_order");
  header.xFastest = order.starts_with("True");
  if (!header.xFastest && !order.starts_with("False"))
    throwInvalid(path, "its NumPy header has no valid fortran_order");
  header.shape = parseShape(path, valueAfter(path, text, "shape"));
  return header;
}

std::string npyHeader(const NpyHeader& header) {
  constexpr size_t kStart = 10, kAlignment = 64;
  std::string text = "{'descr': '" + header.type +
                     "', 'fortran_order': " + (header.xFastest ? "True" : "False") +
                     ", 'shape': " + tuple(header.shape) + ", }";
  text.append(kAlignment - 1 - (kStart + text.size()) % kAlignment, ' ');
  text += '\n';
  std::string bytes(kMagic);
  bytes += {'\x01', '\x00', static_cast<char>(text.size() & 0xff), static_cast<char>(text.size() >> 8)};
  return bytes + text;
}

std::string npyHeader(const Grid& grid, ElementType type) {
  const glm::ivec3 dims = grid.dims;
  const char* name = type == ElementType::UInt32 ? "<u4" : type == ElementType::Float16 ? "<f2" : "<f4";
  return npyHeader({name, true, {dims.x, dims.y, dims.z}});
}

void readNpyArray(const std::filesystem::path& path, Field& field, std::string_view name,
                  const NpyHeader& header, const StoredBytes& stored, const ReadBytes& read) {
  if (header.shape.size() != 3)
    throwInvalid(path, "an array of " + std::to_string(header.shape.size()) + " axes; a field has 3");
  const ArrayLayout layout = layoutOf(path, header);
  const std::array<int64_t, 3> dims{header.shape[0], header.shape[1], header.shape[2]};
  checkedSampleCount(path, dims, layout.type, stored);
  setDims(field.grid, dims);
  readArray(path, field, name, layout, read);
}

Field readNpy(const SourceFile& source, LeftOut&) {
  const std::filesystem::path& path = source.path();
  InputFile file(source);
  const ReadBytes read = [&](void* to, size_t count) { file.read(to, count); };
  Field field;
  field.grid.spacing = 1.0;
  const NpyHeader header = readNpyHeader(path, read);
  readNpyArray(path, field, "", header, {file.remaining()}, read);
  return field;
}

void writeNpy(std::ostream& out, const Field& field, const NamedArray& array) {
  out << frameNpy(field, {&array, 1}).before[0];
  writeBytes(out, array.bytes);
}

void writeHalfNpy(std::ostream& out, const Field& field, const NamedArray& array) {
  Buffer<uint16_t> halves;
  writeNpy(out, field, halvesOf(array, halves));
}

Frame frameNpy(const Field& about, std::span<const NamedArray> arrays) {
  return {.before = {npyHeader(about.grid, arrays.front().type)}};
}

}  // namespace raymap
