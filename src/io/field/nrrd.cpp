// NRRD: a text header, a blank line, the samples. Field names follow the format's definition
// (teem.sourceforge.net/nrrd).

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <ostream>
#include <sstream>

#include "base/text.h"
#include "io/field/field_formats.h"
#include "io/field/gzip.h"

namespace raymap {

namespace {

using Header = std::map<std::string, std::string, std::less<>>;

std::string trimmed(std::string_view text) {
  const size_t begin = text.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(" \t") - begin + 1));
}

Header readHeader(InputFile& file) {
  constexpr size_t kLongestLine = 4096, kMostLines = 1000;
  constexpr std::string_view kMagic = "NRRD000";  // A digit follows.
  const std::string magic = file.readLine(kLongestLine);
  if (!magic.starts_with(kMagic) || magic.size() != kMagic.size() + 1)
    throwInvalid(file.path(), "does not begin as a NRRD");
  Header header;
  for (size_t lines = 0; lines < kMostLines; ++lines) {
    if (file.remaining() == 0) throwInvalid(file.path(), "ends within its header");
    const std::string line = file.readLine(kLongestLine);
    if (line.empty()) return header;
    const size_t colon = line.find(':');
    if (line[0] == '#' || colon == std::string::npos) continue;
    const bool isOwnKey = line.compare(colon, 2, ":=") == 0;
    header[line.substr(0, colon)] = trimmed(std::string_view(line).substr(colon + (isOwnKey ? 2 : 1)));
  }
  throwInvalid(file.path(), "has no end to its header");
}

std::string valueOf(const Header& header, std::string_view key, std::string_view otherwise = "") {
  const auto found = header.find(key);
  return found == header.end() ? std::string(otherwise) : found->second;
}

ElementType typeOf(const std::filesystem::path& path, const Header& header) {
  static const std::map<std::string, ElementType, std::less<>> kTypes{
      {"float", ElementType::Float32}, {"double", ElementType::Float64},
      {"uint", ElementType::UInt32},   {"unsigned int", ElementType::UInt32},
      {"uint32", ElementType::UInt32}, {"uint32_t", ElementType::UInt32},
      {"int", ElementType::Int32},     {"signed int", ElementType::Int32},
      {"int32", ElementType::Int32},   {"int32_t", ElementType::Int32}};
  const std::string type = valueOf(header, "type");
  const auto found = kTypes.find(type);
  if (found == kTypes.end())
    throwUnsupported(path, "samples of type " + excerpt(type) + "; convert them to float");
  return found->second;
}

double cubicSpacing(const std::filesystem::path& path, const std::vector<double>& matrix) {
  constexpr double kTolerance = 1e-5;  // Other programs write single precision or round to a few digits.
  const double spacing = matrix[0];
  for (const double number : matrix)
    if (!std::isfinite(number)) checkSpacing(path, number);
  for (size_t i = 0; i < matrix.size(); ++i)
    if (!(std::abs(matrix[i] - (i % 4 == 0 ? spacing : 0.0)) <= kTolerance * std::abs(spacing)))
      throwUnsupported(path, "its grid is turned, mirrored or not of cubes; resample it");
  return spacing;
}

std::vector<double> numbersOf(const std::filesystem::path& path, const Header& header, std::string_view key,
                              size_t count) {
  const std::string text = valueOf(header, key);
  auto numbers = parseNumbers(text, count);
  if (!numbers)
    throwInvalid(path, "'" + std::string(key) + "' is " + excerpt(text) + ", not " + std::to_string(count) +
                           " numbers");
  return *std::move(numbers);
}

void readPlacement(const std::filesystem::path& path, const Header& header, Grid& grid) {
  grid.spacing = 1.0;
  if (header.contains("space directions")) {
    grid.spacing = cubicSpacing(path, numbersOf(path, header, "space directions", 9));
  } else if (header.contains("spacings")) {
    const auto s = numbersOf(path, header, "spacings", 3);
    grid.spacing = cubicSpacing(path, {s[0], 0, 0, 0, s[1], 0, 0, 0, s[2]});
  }
  for (const char* key : {"space origin", "axis mins"}) {
    if (!header.contains(key)) continue;
    const auto origin = numbersOf(path, header, key, 3);
    grid.origin = {origin[0], origin[1], origin[2]};
    break;
  }
}

}  // namespace

Field readNrrd(const SourceFile& source, LeftOut&) {
  const std::filesystem::path& path = source.path();
  auto file = std::make_shared<InputFile>(source);
  const Header header = readHeader(*file);
  if (header.contains("data file") || header.contains("datafile"))
    throwUnsupported(path, "its samples are in another file; join them (unu save, or pynrrd)");
  if (valueOf(header, "byte skip", "0") != "0" || valueOf(header, "line skip", "0") != "0")
    throwUnsupported(path, "it skips bytes before its samples; save it anew");
  if (valueOf(header, "dimension") != "3")
    throwUnsupported(path,
                     "'dimension' is " + excerpt(valueOf(header, "dimension")) + "; a field has 3 axes");
  const std::string encoding = valueOf(header, "encoding");
  const bool isDeflated = encoding == "gzip" || encoding == "gz";
  if (!isDeflated && encoding != "raw")
    throwUnsupported(path, "encoding " + excerpt(encoding) + "; save it with raw or gzip");

  Field field;
  const std::string endian = valueOf(header, "endian", "little");
  if (endian != "little" && endian != "big")
    throwInvalid(path, "'endian' is " + excerpt(endian) + ", neither little nor big");
  const ArrayLayout layout{typeOf(path, header), endian == "big"};
  const auto dims = parseDims(valueOf(header, "sizes"));
  if (!dims)
    throwInvalid(path, "'sizes' is " + excerpt(valueOf(header, "sizes")) + ", not three whole numbers");
  checkedSampleCount(path, *dims, layout.type, {file->remaining(), isDeflated});
  setDims(field.grid, *dims);
  readPlacement(path, header, field.grid);
  for (const char* name : {kFormerClampDistance, kClampDistance})
    if (header.contains(name)) field.clampDistance = numbersOf(path, header, name, 1)[0];
  if (header.contains(kSurfaceBounds))
    setSurfaceBounds(path, numbersOf(path, header, kSurfaceBounds, 6), field);
  checkPlacement(path, field);
  readArray(
      path, field, valueOf(header, "content"), layout,
      isDeflated ? inflated(file) : [&](void* to, size_t count) { file->read(to, count); });
  return field;
}

void writeNrrd(std::ostream& out, const Field& field, const NamedArray& array) {
  out << frameNrrd(field, {&array, 1}).before[0];
  writeBytes(out, array.bytes);
}

Frame frameNrrd(const Field& about, std::span<const NamedArray> arrays) {
  const Grid& grid = about.grid;
  const NamedArray& array = arrays.front();
  std::ostringstream out;
  const std::string h = toText(grid.spacing);
  out << "NRRD0004\n"
      << "type: " << (array.type == ElementType::UInt32 ? "uint32" : "float") << "\n"
      << "dimension: 3\n"
      << "space: 3D-right-handed\n"
      << "sizes: " << grid.dims.x << ' ' << grid.dims.y << ' ' << grid.dims.z << "\n"
      << "space directions: (" << h << ",0,0) (0," << h << ",0) (0,0," << h << ")\n"
      << "kinds: domain domain domain\n"
      << "endian: little\n"
      << "encoding: raw\n"
      << "space origin: (" << toText(grid.origin.x) << ',' << toText(grid.origin.y) << ','
      << toText(grid.origin.z) << ")\n"
      << "content: " << array.name << "\n";
  if (about.clampDistance > 0.0) out << kClampDistance << ":=" << toText(about.clampDistance) << "\n";
  if (!about.surfaceBounds.isEmpty()) out << kSurfaceBounds << ":=" << toText(surfaceBoundsOf(about)) << "\n";
  out << '\n';
  return {.before = {std::move(out).str()}};
}

}  // namespace raymap
