// VTK's ImageData: XML and samples. The writer appends the samples as raw bytes.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <ostream>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "base/text.h"
#include "io/field/field_formats.h"
#include "io/field/vti_data.h"

namespace raymap {

namespace {

namespace fs = std::filesystem;

/// A file in memory. `appended` holds the bytes after the underscore of its appended data.
struct VtiFile {
  fs::path path;
  Buffer<char> bytes;
  pugi::xml_document xml;
  std::string_view appended;
  bool appendedIsRaw = false;
  bool bigEndian = false;
  bool longHeader = false;
  bool isDeflated = false;
};

void load(VtiFile& file, const SourceFile& source) {
  InputFile input(source);
  file.bytes.resizeUninitialized(input.remaining());
  input.read(file.bytes.data(), file.bytes.size());
  const std::string_view text(file.bytes.data(), file.bytes.size());
  const size_t end = std::min(text.find("<AppendedData"), text.size());
  const auto parsed = file.xml.load_buffer(text.data(), end, pugi::parse_default, pugi::encoding_utf8);
  const bool isCut = end < text.size();
  if (!parsed && !(isCut && parsed.status == pugi::status_end_element_mismatch))
    throwInvalid(file.path, std::string("is no VTK file: ") + parsed.description());
  if (!isCut) return;
  const size_t close = text.find('>', end), start = text.find('_', std::min(close, text.size()));
  if (start == std::string_view::npos) throwInvalid(file.path, "its appended data has no beginning");
  file.appended = text.substr(start + 1);
  file.appendedIsRaw = text.substr(end, close - end).find("raw") != std::string_view::npos;
}

std::vector<double> numbersOf(const VtiFile& file, const pugi::xml_node& node, const char* attribute,
                              size_t count, const char* otherwise) {
  const std::string text = node.attribute(attribute).as_string(otherwise);
  auto numbers = parseNumbers(text, count);
  if (!numbers)
    throwInvalid(file.path, std::string(attribute) + " is " + excerpt(text) + ", not " +
                                std::to_string(count) + (count == 1 ? " number" : " numbers"));
  return *std::move(numbers);
}

/// Sets the grid's origin and spacing. Returns the dimensions, which are still unchecked.
std::array<int64_t, 3> readGrid(const VtiFile& file, const pugi::xml_node& image, Grid& grid) {
  const auto extent = numbersOf(file, image, "WholeExtent", 6, "");
  const auto origin = numbersOf(file, image, "Origin", 3, "0 0 0");
  const auto spacing = numbersOf(file, image, "Spacing", 3, "1 1 1");
  const auto direction = numbersOf(file, image, "Direction", 9, "1 0 0 0 1 0 0 0 1");
  constexpr double kTolerance = 1e-5;
  std::array<int64_t, 3> dims{};
  for (size_t axis = 0; axis < 3; ++axis) {
    checkSpacing(file.path, spacing[axis]);
    if (std::abs(spacing[axis] - spacing[0]) > kTolerance * spacing[0])
      throwUnsupported(file.path, "its cells are not cubes; resample it");
    const double first = extent[2 * axis], last = extent[2 * axis + 1];
    if (!(std::abs(first) < 1e9 && std::abs(last) < 1e9) || first != std::trunc(first) ||
        last != std::trunc(last))
      throwInvalid(file.path, "its extent is out of range, or not of whole numbers");
    dims[axis] = static_cast<int64_t>(last) - static_cast<int64_t>(first) + 1;
    grid.origin[static_cast<int>(axis)] = first == 0.0 ? origin[axis] : origin[axis] + first * spacing[0];
  }
  for (size_t i = 0; i < 9; ++i)
    if (direction[i] != (i % 4 == 0 ? 1.0 : 0.0))
      throwUnsupported(file.path, "its grid is turned; resample it");
  grid.spacing = spacing[0];
  return dims;
}

/// Returns the arrays to read: all that a field has, or else the one that is marked as the scalars, or else
/// the first one.
std::vector<pugi::xml_node> findArrays(const VtiFile& file, const pugi::xml_node& image) {
  const pugi::xml_node piece = image.child("Piece");
  if (!piece || piece.next_sibling("Piece"))
    throwUnsupported(file.path, "it is not of one piece; save it as one");
  if (std::string_view(piece.attribute("Extent").as_string()) != image.attribute("WholeExtent").as_string())
    throwUnsupported(file.path, "its piece is not the whole; save it anew");
  const pugi::xml_node points = piece.child("PointData");
  std::vector<pugi::xml_node> arrays;
  std::set<std::string> seen;
  for (const pugi::xml_node& array : points.children("DataArray")) {
    const std::string name = array.attribute("Name").as_string();
    if (!isFieldArray(name)) continue;
    if (!seen.insert(name).second) throwInvalid(file.path, "it has the array '" + name + "' twice");
    arrays.push_back(array);
  }
  if (arrays.empty()) {
    const char* name = points.attribute("Scalars").as_string();
    const pugi::xml_node scalars = points.find_child_by_attribute("DataArray", "Name", name);
    arrays.push_back(scalars ? scalars : points.child("DataArray"));
  }
  if (!arrays.front()) throwInvalid(file.path, "it has no point data");
  for (const pugi::xml_node& array : arrays)
    if (array.attribute("NumberOfComponents").as_int(1) != 1)
      throwUnsupported(file.path, "its samples are vectors");
  return arrays;
}

ElementType typeOf(const VtiFile& file, const pugi::xml_node& array) {
  static const std::map<std::string, ElementType, std::less<>> kTypes{{"Float32", ElementType::Float32},
                                                                      {"Float64", ElementType::Float64},
                                                                      {"UInt32", ElementType::UInt32},
                                                                      {"Int32", ElementType::Int32}};
  const auto found = kTypes.find(array.attribute("type").as_string());
  if (found == kTypes.end())
    throwUnsupported(file.path, "samples of type " + excerpt(array.attribute("type").as_string()) +
                                    "; convert them to Float32");
  return found->second;
}

ReadBytes memoryReader(const fs::path& path, std::string_view bytes) {
  return [path, bytes](void* to, size_t count) mutable {
    if (count > bytes.size()) throwInvalid(path, "its data ends early");
    std::memcpy(to, bytes.data(), count);
    bytes.remove_prefix(count);
  };
}

uint64_t readCount(const VtiFile& file, const ReadBytes& read) {
  std::array<unsigned char, 8> bytes{};
  const size_t size = file.longHeader ? 8 : 4;
  read(bytes.data(), size);
  if (file.bigEndian) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
  uint64_t count = 0;
  std::memcpy(&count, bytes.data(), sizeof count);
  return count;
}

/// Returns a reader of the samples that `text` encodes after their header. They have `bytes` bytes.
ReadBytes binaryReader(const VtiFile& file, std::string_view text, bool isRaw, uint64_t bytes) {
  ReadBytes read = isRaw ? memoryReader(file.path, text) : base64Decoded(file.path, text);
  if (file.isDeflated)
    return blocksInflated(
        file.path, read, [&] { return readCount(file, read); }, bytes, text.size());
  const uint64_t declared = readCount(file, read);
  if (declared != bytes)
    throwInvalid(file.path, "declares " + std::to_string(declared) +
                                " bytes of samples where its extent needs " + std::to_string(bytes));
  return read;
}

/// Elements of an array, in the order of the file.
struct Elements {
  ArrayLayout layout;
  ReadBytes read;
};

/// Opens an array of these dimensions, however it is encoded.
Elements openArray(const VtiFile& file, const pugi::xml_node& array, const std::array<int64_t, 3>& dims) {
  const std::string_view format = array.attribute("format").as_string("ascii");
  const ArrayLayout layout{typeOf(file, array), file.bigEndian};
  const bool isAppended = format == "appended";
  if (!isAppended && format != "binary" && format != "ascii")
    throwInvalid(file.path, "format " + excerpt(format) + " is unknown");
  std::string_view text = isAppended ? file.appended : std::string_view(array.text().get());
  if (isAppended) {
    const double offset = numbersOf(file, array, "offset", 1, "0")[0];
    if (!(offset >= 0.0 && offset <= static_cast<double>(text.size())))
      throwInvalid(file.path, "its samples begin outside of its appended data");
    text.remove_prefix(static_cast<size_t>(offset));
  }
  if (format == "ascii") {
    const bool isWhole = layout.type == ElementType::UInt32 || layout.type == ElementType::Int32;
    const ArrayLayout decoded{isWhole ? ElementType::UInt32 : ElementType::Float64};
    checkedSampleCount(file.path, dims, decoded.type, {(text.size() + 1) / 2 * elementSize(decoded.type)});
    return {decoded, decimalDecoded(file.path, text, isWhole)};
  }
  const size_t count = checkedSampleCount(file.path, dims, layout.type, {text.size(), file.isDeflated});
  return {layout,
          binaryReader(file, text, isAppended && file.appendedIsRaw, count * elementSize(layout.type))};
}  // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks): it misses that the function's destructor frees it.

void readSamples(const VtiFile& file, const pugi::xml_node& array, const std::array<int64_t, 3>& dims,
                 Field& field) {
  const Elements elements = openArray(file, array, dims);
  setDims(field.grid, dims);
  readArray(file.path, field, array.attribute("Name").as_string(), elements.layout, elements.read);
}

/// Reads numbers of the field, which other programs encode as they encode all arrays. Returns whether they
/// are there.
bool readNumbers(const VtiFile& file, const pugi::xml_node& image, const char* name,
                 std::span<double> numbers) {
  const pugi::xml_node array = image.child("FieldData").find_child_by_attribute("DataArray", "Name", name);
  if (!array) return false;
  const Elements elements = openArray(file, array, {int64_t(numbers.size()), 1, 1});
  readReals(numbers, elements.layout, elements.read);
  return true;
}

void writeNumbers(std::ostream& out, const char* name, std::span<const double> numbers) {
  out << "      <DataArray type=\"Float64\" Name=\"" << name << "\" NumberOfTuples=\"" << numbers.size()
      << "\" format=\"ascii\">" << toText(numbers) << "</DataArray>\n";
}

/// Writes what the field knows besides its arrays.
void writeFieldData(std::ostream& out, const Field& field) {
  const bool isClamped = field.clampDistance > 0.0, hasBounds = !field.surfaceBounds.isEmpty();
  if (!isClamped && !hasBounds) return;
  out << "    <FieldData>\n";
  if (isClamped) writeNumbers(out, kClampDistance, {&field.clampDistance, 1});
  if (hasBounds) writeNumbers(out, kSurfaceBounds, surfaceBoundsOf(field));
  out << "    </FieldData>\n";
}

/// Returns the text before the appended arrays.
std::string headOf(const Field& field, std::span<const NamedArray> arrays) {
  const Grid& grid = field.grid;
  const std::string h = toText(grid.spacing);
  const std::string extent = "0 " + std::to_string(grid.dims.x - 1) + " 0 " +
                             std::to_string(grid.dims.y - 1) + " 0 " + std::to_string(grid.dims.z - 1);
  std::ostringstream out;
  out << "<?xml version=\"1.0\"?>\n"
      << "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      << "  <ImageData WholeExtent=\"" << extent << "\" Origin=\"" << toText(grid.origin.x) << ' '
      << toText(grid.origin.y) << ' ' << toText(grid.origin.z) << "\" Spacing=\"" << h << ' ' << h << ' ' << h
      << "\">\n";
  writeFieldData(out, field);
  out << "    <Piece Extent=\"" << extent << "\">\n      <PointData Scalars=\"" << arrays.front().name
      << "\">\n";
  uint64_t offset = 0;
  for (const NamedArray& each : arrays) {
    out << "        <DataArray type=\"" << (each.type == ElementType::UInt32 ? "UInt32" : "Float32")
        << "\" Name=\"" << each.name << "\" format=\"appended\" offset=\"" << offset << "\"/>\n";
    offset += sizeof offset + arrayBytes(grid, each);
  }
  out << "      </PointData>\n    </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n_";
  return std::move(out).str();
}

std::string countBefore(const Grid& grid, const NamedArray& array) {
  const uint64_t count = arrayBytes(grid, array);
  return {reinterpret_cast<const char*>(&count), sizeof count};
}

constexpr const char* kTail = "\n  </AppendedData>\n</VTKFile>\n";

}  // namespace

Field readVti(const SourceFile& source, LeftOut& leftOut) {
  const fs::path& path = source.path();
  VtiFile file;
  file.path = path;
  load(file, source);
  const pugi::xml_node root = file.xml.child("VTKFile"), image = root.child("ImageData");
  if (!image || std::string_view(root.attribute("type").as_string()) != "ImageData")
    throwInvalid(path, "it holds no ImageData");
  const std::string_view compressor = root.attribute("compressor").as_string();
  file.isDeflated = compressor == "vtkZLibDataCompressor";
  if (!compressor.empty() && !file.isDeflated)
    throwUnsupported(path, "compressed with " + shortText(compressor, kLongestName) +
                               "; save it with vtkZLibDataCompressor");
  file.bigEndian = std::string_view(root.attribute("byte_order").as_string()) == "BigEndian";
  file.longHeader = std::string_view(root.attribute("header_type").as_string()) == "UInt64";

  Field field;
  const auto dims = readGrid(file, image, field.grid);
  for (const char* name : {kFormerClampDistance, kClampDistance})
    readNumbers(file, image, name, {&field.clampDistance, 1});
  if (std::array<double, 6> box{}; readNumbers(file, image, kSurfaceBounds, box))
    setSurfaceBounds(path, box, field);
  checkPlacement(path, field);
  const std::vector<pugi::xml_node> arrays = findArrays(file, image);
  for (const pugi::xml_node& array : arrays) readSamples(file, array, dims, field);
  for (const char* data : {"PointData", "CellData"})
    for (const pugi::xml_node& array : image.child("Piece").child(data).children())
      if (std::ranges::count(arrays, array) == 0) leftOut.emplace_back(array.attribute("Name").as_string());
  return field;
}

void writeVti(std::ostream& out, const Field& field, const NamedArray& array) {
  const std::vector<NamedArray> arrays = arraysWith(field, array);
  const Frame frame = frameVti(field, arrays);
  for (size_t i = 0; i < arrays.size(); ++i) {
    out << frame.before[i];
    writeBytes(out, arrays[i].bytes);
  }
  out << frame.tail;
}

Frame frameVti(const Field& about, std::span<const NamedArray> arrays) {
  Frame frame{.before = {}, .tail = kTail};
  for (const NamedArray& each : arrays) frame.before.push_back(countBefore(about.grid, each));
  frame.before.front().insert(0, headOf(about, arrays));
  return frame;
}

}  // namespace raymap
