#include "io/mesh/ply_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/text.h"
#include "io/mesh/text_scanner.h"

namespace raymap {

namespace {

PlyType readType(TextScanner& text) {
  static constexpr std::array<std::pair<std::string_view, PlyType>, 20> kTypes{
      {{"char", PlyType::Int8},     {"int8", PlyType::Int8},     {"uchar", PlyType::UInt8},
       {"uint8", PlyType::UInt8},   {"short", PlyType::Int16},   {"int16", PlyType::Int16},
       {"ushort", PlyType::UInt16}, {"uint16", PlyType::UInt16}, {"int", PlyType::Int32},
       {"int32", PlyType::Int32},   {"uint", PlyType::UInt32},   {"uint32", PlyType::UInt32},
       {"long", PlyType::Int64},    {"int64", PlyType::Int64},   {"ulong", PlyType::UInt64},
       {"uint64", PlyType::UInt64}, {"float", PlyType::Float},   {"float32", PlyType::Float},
       {"double", PlyType::Double}, {"float64", PlyType::Double}}};
  const std::string_view word = text.moreOnLine() ? text.word() : std::string_view();
  const auto* type = std::ranges::find(kTypes, word, &std::pair<std::string_view, PlyType>::first);
  if (type == kTypes.end()) text.fail("expected the type of a property, found " + excerpt(word));
  return type->second;
}

PlyFormat readFormat(TextScanner& text) {
  const std::string_view word = text.word();
  if (word == "ascii") return PlyFormat::Text;
  if (word == "binary_little_endian") return PlyFormat::LittleEndian;
  if (word == "binary_big_endian") return PlyFormat::BigEndian;
  text.fail("unknown PLY format " + excerpt(word));
}

PlyElement readElement(TextScanner& text) {
  PlyElement element;
  element.name = text.word();
  const int64_t count = text.integer();
  if (count < 0)
    text.fail("element " + shortText(element.name) + " has a negative count: " + std::to_string(count));
  element.count = static_cast<uint64_t>(count);
  return element;
}

PlyProperty readProperty(TextScanner& text) {
  PlyProperty property;
  TextScanner ahead = text;
  if (ahead.word() == "list") {
    text.word();
    property.isList = true;
    property.countType = readType(text);
  }
  property.type = readType(text);
  property.name = text.word();
  return property;
}

/// Returns the least number of bytes that a row of the element takes.
uint64_t smallestRow(const PlyElement& element, PlyFormat format) {
  uint64_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    if (format == PlyFormat::Text)
      bytes += 2;  // A digit and a space.
    else
      bytes += plyTypeBytes(property.isList ? property.countType : property.type);
  }
  return bytes;
}

/// Throws if the file is too small for a count, which would only cost memory and time, or if two elements
/// have the same name.
void checkCounts(const MeshFile& file, const PlyHeader& header) {
  const uint64_t room = file.bytes.size() - header.bytes + 1;  // The last text line may lack its end.
  for (const PlyElement& element : header.elements) {
    const uint64_t row = smallestRow(element, header.format);
    if (row > 0 && element.count > room / row)
      file.fail("the header announces " + counted(element.count, shortText(element.name)) + " of at least " +
                counted(row, "byte") + ", but only " + counted(room - 1, "byte") +
                " follow it: the file is cut short, or the count is wrong");
    if (std::ranges::count(header.elements, element.name, &PlyElement::name) > 1)
      file.fail("two elements are called " + excerpt(element.name));
  }
}

}  // namespace

size_t plyTypeBytes(PlyType type) {
  switch (type) {
    case PlyType::Int8:
    case PlyType::UInt8:
      return 1;
    case PlyType::Int16:
    case PlyType::UInt16:
      return 2;
    case PlyType::Int32:
    case PlyType::UInt32:
    case PlyType::Float:
      return 4;
    case PlyType::Int64:
    case PlyType::UInt64:
    case PlyType::Double:
      break;
  }
  return 8;
}

int PlyElement::find(std::string_view property) const {
  const auto found = std::ranges::find(properties, property, &PlyProperty::name);
  return found == properties.end() ? -1 : static_cast<int>(found - properties.begin());
}

int PlyElement::findCoordinate(int axis) const {
  const int small = find(std::string_view("xyz").substr(static_cast<size_t>(axis), 1));
  return small >= 0 ? small : find(std::string_view("XYZ").substr(static_cast<size_t>(axis), 1));
}

const PlyElement* PlyHeader::find(std::string_view element) const {
  const auto found = std::ranges::find(elements, element, &PlyElement::name);
  return found == elements.end() ? nullptr : &*found;
}

PlyHeader readPlyHeader(const MeshFile& file) {
  TextScanner text(file);
  if (text.word() != "ply") file.fail("not a PLY file: it does not begin with 'ply'");
  // A file whose lines end in CR alone may have data that begins with a byte equal to LF.
  const bool crOnly = file.text().substr(text.position()).starts_with('\r') &&
                      !file.text().substr(text.position()).starts_with("\r\n");
  PlyHeader header;
  bool hasFormat = false;
  for (;;) {
    text.nextLine();
    const std::string_view keyword = text.word();
    if (keyword == "end_header") break;
    if (keyword == "format") {
      header.format = readFormat(text);
      hasFormat = true;
    } else if (keyword == "element") {
      header.elements.push_back(readElement(text));
    } else if (keyword == "property") {
      if (header.elements.empty()) text.fail("a property before the first element");
      header.elements.back().properties.push_back(readProperty(text));
    } else if (keyword.empty()) {
      text.fail("the file ends within its header");
    } else if (keyword != "comment" && keyword != "obj_info") {
      text.fail("expected element, property or end_header, found " + excerpt(keyword));
    }
  }
  if (!hasFormat) text.fail("the header has no format line");
  text.restOfLine();
  header.bytes = text.position();
  if (header.bytes < file.bytes.size()) {
    text.nextLine();
    header.bytes = crOnly ? header.bytes + 1 : text.position();
  }
  checkCounts(file, header);
  return header;
}

}  // namespace raymap
