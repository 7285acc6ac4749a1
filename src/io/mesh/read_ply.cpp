// Stanford PLY: text and binary of both byte orders; faces as polygons or triangle strips; elements and
// properties in any order.

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <memory>

#include "base/text.h"
#include "io/mesh/mesh_file.h"
#include "io/mesh/ply_header.h"
#include "io/mesh/text_scanner.h"

namespace raymap {

namespace {

static_assert(std::endian::native == std::endian::little);

/// How a text file's rows lie in its lines.
enum class TextRows {
  Lines,  ///< Each row begins a line. A short one continues on the next line; a long one is cut at its end.
  Values  ///< Line breaks mean nothing.
};

/// Values of a text file.
class TextSource {
 public:
  TextSource(const MeshFile& file, const PlyHeader& header, TextRows rows)
      : file_(file), text_(file, header.bytes), rows_(rows) {}

  double real(PlyType) { return text_.real(); }
  int64_t integer(PlyType) { return text_.integer(); }
  void skip(PlyType, uint64_t count) {
    for (; count > 0; --count)
      if (text_.word().empty()) text_.fail("the file ends too early");
  }

  void beginRow() {
    text_.more();
    row_ = text_.position();
  }
  void endRow(const PlyElement& element) {
    if (rows_ == TextRows::Values || !text_.moreOnLine()) return;
    if (cutRows_++ == 0) {
      cutAt_ = text_.position();
      cutElement_ = element.name;
    }
    const std::string_view row = file_.text().substr(row_, text_.position() - row_);
    if (row.find_first_of("\r\n") != row.npos)
      text_.failAt(row_, "the line has fewer values than the header declares for " + excerpt(element.name) +
                             ", and the row does not end with a later line either");
    size_t values = 0;
    for (; text_.moreOnLine(); ++values) text_.word();
    if (cutRows_ == 1) cutValues_ = values;
  }

  bool isAtEnd() { return !text_.more(); }
  bool hasCutRows() const { return cutRows_ > 0; }
  /// Warns of the first row that was cut, if one was.
  void warnCutRows() const {
    if (cutValues_ == 0) return;
    file_.warnThat("line " + std::to_string(text_.lineAt(cutAt_)) + ": " + counted(cutValues_, "value") +
                   " more than the header declares for " + excerpt(cutElement_) + " ignored" +
                   (cutRows_ > 1 ? ", as on " + counted(cutRows_ - 1, "later line") : ""));
  }

 private:
  const MeshFile& file_;
  TextScanner text_;
  TextRows rows_;
  size_t row_ = 0;                                  // Where the current row begins.
  size_t cutRows_ = 0, cutAt_ = 0, cutValues_ = 0;  // Number of rows cut; the first one's end and excess.
  std::string cutElement_;
};

/// Values of a binary file.
class BinarySource {
 public:
  BinarySource(const MeshFile& file, const PlyHeader& header)
      : file_(file),
        at_(file.bytes.data() + header.bytes),
        end_(file.bytes.data() + file.bytes.size()),
        swap_(header.format == PlyFormat::BigEndian) {}

  double real(PlyType type) {
    switch (type) {
      case PlyType::Float:
        return std::bit_cast<float>(load<uint32_t>());
      case PlyType::Double:
        return std::bit_cast<double>(load<uint64_t>());
      case PlyType::UInt64:
        return static_cast<double>(load<uint64_t>());
      default:
        return static_cast<double>(integer(type));
    }
  }

  int64_t integer(PlyType type) {
    switch (type) {
      case PlyType::Int8:
        return static_cast<int8_t>(load<uint8_t>());
      case PlyType::UInt8:
        return load<uint8_t>();
      case PlyType::Int16:
        return static_cast<int16_t>(load<uint16_t>());
      case PlyType::UInt16:
        return load<uint16_t>();
      case PlyType::Int32:
        return static_cast<int32_t>(load<uint32_t>());
      case PlyType::UInt32:
        return load<uint32_t>();
      case PlyType::Int64:
        return static_cast<int64_t>(load<uint64_t>());
      case PlyType::UInt64:
        return signedOf(load<uint64_t>());
      default:
        return wholeNumber(real(type));
    }
  }

  void skip(PlyType type, uint64_t count) {
    need(count * plyTypeBytes(type));
    at_ += count * plyTypeBytes(type);
  }

  void beginRow() {}
  void endRow(const PlyElement&) {}

 private:
  template <std::unsigned_integral T>
  T load() {
    need(sizeof(T));
    T value;
    std::memcpy(&value, at_, sizeof value);
    at_ += sizeof value;
    return swap_ ? swapped(value) : value;
  }

  template <std::unsigned_integral T>
  static T swapped(T value) {
    T result = 0;
    for (size_t i = 0; i < sizeof(T); ++i) result = static_cast<T>(result << 8 | (value >> 8 * i & 0xff));
    return result;
  }

  /// Returns -1 for the largest number, which ends a strip. Others that are too large stay so.
  static int64_t signedOf(uint64_t value) {
    return value == UINT64_MAX ? -1 : static_cast<int64_t>(std::min(value, uint64_t{INT64_MAX}));
  }

  int64_t wholeNumber(double value) const {
    if (!(std::abs(value) <= 0x1p53) || value != std::floor(value))
      file_.fail("an index or a count is not a whole number: " + std::to_string(value));
    return static_cast<int64_t>(value);
  }

  void need(uint64_t bytes) const {
    if (bytes > static_cast<uint64_t>(end_ - at_)) file_.fail("the file ends too early: it is cut short");
  }

  const MeshFile& file_;
  const std::byte* at_;
  const std::byte* end_;
  bool swap_;
};

/// Numbers of a vertex by which properties are told apart: first the coordinates.
constexpr int kRed = 3, kAlpha = 6, kU = 7, kV = 8, kUnread = 9;

/// Returns what a value of a colour is divided by to lie from 0 to 1.
float fullColour(PlyType type) {
  if (type == PlyType::Float || type == PlyType::Double) return 1.0F;
  return type == PlyType::UInt16 ? 65535.0F : 255.0F;
}

/// Sets the numbers of properties that are colours or texture coordinates, if all of one kind are there.
void findAttributes(const PlyElement& element, std::vector<int>& target) {
  const auto set = [&](std::initializer_list<std::string_view> names, int first) {
    const auto isScalar = [&](std::string_view name) {
      const int place = element.find(name);
      return place >= 0 && !element.properties[size_t(place)].isList;
    };
    if (!std::ranges::all_of(names, isScalar)) return false;
    for (const std::string_view name : names) target[size_t(element.find(name))] = first++;
    return true;
  };
  if (set({"red", "green", "blue"}, kRed)) set({"alpha"}, kAlpha);
  if (!set({"s", "t"}, kU) && !set({"u", "v"}, kU)) set({"texture_u", "texture_v"}, kU);
}

/// Appends the properties of an element that are not read, in words. Normals follow from the faces.
void noteUnread(const PlyElement& element, const std::vector<int>& target, const char* owners,
                std::vector<std::string>& lost) {
  constexpr std::array<std::string_view, 10> kKnown{
      "nx", "ny", "nz", "red", "green", "blue", "alpha", "flags", "vertex_indices", "vertex_index"};
  std::vector<std::string> names;
  bool hasColours = false;
  for (size_t i = 0; i < element.properties.size(); ++i) {
    const std::string& name = element.properties[i].name;
    if (target[i] != kUnread) continue;
    hasColours = hasColours || name == "red";
    if (std::ranges::find(kKnown, name) == kKnown.end()) names.push_back(shortText(name));
  }
  constexpr size_t kMostNames = 3;
  if (hasColours) lost.push_back(std::string("colours of ") + owners);
  if (names.size() > kMostNames) names = {std::to_string(names.size()) + " properties"};
  for (const std::string& name : names) lost.push_back(name + " of " + owners);
}

/// Part of a file that is read.
enum class PlyContent { Mesh, Points };

/// Reads the elements. `Vec` is single precision if the file has no more.
template <class Source, class Vec>
class PlyReader {
 public:
  template <class... Options>
  PlyReader(const MeshFile& file, const PlyHeader& header, PlyContent content, Options... options)
      : file_(file), header_(header), content_(content), source_(file, header, options...) {}

  void readElements() {
    if (!header_.find("vertex")) file_.fail("no 'vertex' element");
    if (content_ == PlyContent::Mesh && !header_.find("face") && !header_.find("tristrips"))
      file_.fail("no 'face' or 'tristrips' element");
    for (const PlyElement& element : header_.elements) readElement(element);
  }
  Source& source() { return source_; }

  Mesh finish() {
    warnOfPolygons(file_, polygons_.dropped(), polygons_.cut(positions_));
    if (file_.attributes) {
      if (!found_.colours.values.empty()) found_.colours.corners = polygons_.triangles;
      if (!found_.uvs.values.empty()) found_.uvs.corners = polygons_.triangles;
      *file_.attributes = std::move(found_);
    }
    return finishMesh(file_, std::move(positions_), std::move(polygons_.triangles));
  }
  std::vector<Vec> takePositions() { return std::move(positions_); }

 private:
  void readElement(const PlyElement& element) {
    if (element.name == "vertex")
      readVertices(element);
    else if (content_ == PlyContent::Mesh && (element.name == "face" || element.name == "tristrips"))
      readFaces(element);
    else if (!element.properties.empty())
      forEachRow(element, [&](uint64_t) {
        for (const PlyProperty& property : element.properties) skip(property);
      });
  }

  template <class Read>
  void forEachRow(const PlyElement& element, Read&& read) {
    for (uint64_t row = 0; row < element.count; ++row) {
      source_.beginRow();
      read(row);
      source_.endRow(element);
    }
  }

  void readVertices(const PlyElement& element) {
    // Number of a vertex that each property sets.
    std::vector<int> target(element.properties.size(), kUnread);
    for (int c = 0; c < 3; ++c) {
      const int place = element.findCoordinate(c);
      if (place < 0 || element.properties[static_cast<size_t>(place)].isList)
        file_.fail(std::string("the vertices have no property ") + "xyz"[c]);
      target[static_cast<size_t>(place)] = c;
    }
    if (file_.attributes && content_ == PlyContent::Mesh) {
      findAttributes(element, target);
      noteUnread(element, target, "vertices", found_.lost);
    }
    const auto has = [&](int number) { return std::ranges::find(target, number) != target.end(); };
    const bool hasColours = has(kRed), hasUvs = has(kU);
    std::array<float, kUnread> numbers{};
    numbers[kAlpha] = 1.0F;
    positions_.reserve(element.count);
    forEachRow(element, [&](uint64_t) {
      glm::vec<4, typename Vec::value_type> p;
      for (size_t i = 0; i < element.properties.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        if (target[i] < 3)
          p[target[i]] = static_cast<typename Vec::value_type>(source_.real(property.type));
        else if (target[i] == kUnread)
          skip(property);
        else
          numbers[size_t(target[i])] = static_cast<float>(source_.real(property.type)) /
                                       (target[i] < kU ? fullColour(property.type) : 1.0F);
      }
      positions_.emplace_back(p);
      if (hasColours)
        found_.colours.values.emplace_back(numbers[kRed], numbers[kRed + 1], numbers[kRed + 2],
                                           numbers[kAlpha]);
      if (hasUvs) found_.uvs.values.emplace_back(numbers[kU], numbers[kV]);
    });
  }

  void readFaces(const PlyElement& element) {
    int list = element.find("vertex_indices");
    if (list < 0) list = element.find("vertex_index");
    if (list < 0 || !element.properties[static_cast<size_t>(list)].isList)
      file_.fail("element " + excerpt(element.name) + " has no list 'vertex_indices'");
    const bool areStrips = element.name == "tristrips";
    if (file_.attributes)
      noteUnread(element, std::vector(element.properties.size(), kUnread), "faces", found_.lost);
    if (!areStrips) polygons_.reserve(element.count);
    forEachRow(element, [&](uint64_t row) {
      for (size_t i = 0; i < element.properties.size(); ++i) {
        if (static_cast<int>(i) != list)
          skip(element.properties[i]);
        else if (areStrips)
          readStrips(element.properties[i], row);
        else
          readPolygon(element.properties[i], row);
      }
    });
  }

  void readPolygon(const PlyProperty& list, uint64_t row) {
    const uint64_t count = readCount(list);
    corners_.clear();
    for (uint64_t i = 0; i < count; ++i) {
      const int64_t vertex = source_.integer(list.type);
      checkIndex(vertex, "face ", row);
      corners_.push_back(static_cast<uint32_t>(vertex));
    }
    polygons_.add(corners_);
  }

  /// Reads a list of strips, each ended by -1 (2^32 - 1 in an unsigned type).
  void readStrips(const PlyProperty& list, uint64_t row) {
    const uint64_t count = readCount(list);
    corners_.clear();
    for (uint64_t i = 0; i < count; ++i) {
      const int64_t vertex = source_.integer(list.type);
      if (vertex == -1 || (list.type == PlyType::UInt32 && vertex == int64_t{UINT32_MAX})) {
        appendStrip(corners_, polygons_.triangles);
        corners_.clear();
        continue;
      }
      checkIndex(vertex, "triangle strip ", row);
      corners_.push_back(static_cast<uint32_t>(vertex));
    }
    appendStrip(corners_, polygons_.triangles);
  }

  void checkIndex(int64_t vertex, std::string_view what, uint64_t row) const {
    const uint64_t vertexCount = header_.find("vertex")->count;
    if (vertex < 0 || static_cast<uint64_t>(vertex) >= vertexCount)
      file_.fail(std::string(what) + std::to_string(row) + ": " + outOfRange(vertex, vertexCount));
  }

  uint64_t readCount(const PlyProperty& list) {
    const int64_t count = source_.integer(list.countType);
    if (count < 0 || static_cast<uint64_t>(count) > file_.bytes.size())
      file_.fail("a list " + excerpt(list.name) + " announces " + std::to_string(count) +
                 " values, but the file has " + counted(file_.bytes.size(), "byte"));
    return static_cast<uint64_t>(count);
  }

  void skip(const PlyProperty& property) {
    source_.skip(property.type, property.isList ? readCount(property) : 1);
  }

  const MeshFile& file_;
  const PlyHeader& header_;
  PlyContent content_;
  Source source_;
  std::vector<Vec> positions_;
  Polygons polygons_;
  std::vector<uint32_t> corners_;
  MeshAttributes found_;
};

/// Returns whether single precision holds the positions of the binary file exactly.
bool fitsFloat(const PlyHeader& header) {
  const PlyElement* vertex = header.find("vertex");
  return vertex && std::ranges::none_of(vertex->properties, [](const PlyProperty& property) {
           return property.type == PlyType::Double || property.type == PlyType::Int32 ||
                  property.type == PlyType::UInt32 || property.type == PlyType::Int64 ||
                  property.type == PlyType::UInt64;
         });
}

using TextReader = PlyReader<TextSource, glm::dvec3>;

/// Reads the values of a text file one after the other. Returns the reader if they end with the file, else
/// null.
std::unique_ptr<TextReader> readValues(const MeshFile& file, const PlyHeader& header, PlyContent content) {
  auto reader = std::make_unique<TextReader>(file, header, content, TextRows::Values);
  try {
    reader->readElements();
  } catch (const Error&) {
    return nullptr;
  }
  return reader->source().isAtEnd() ? std::move(reader) : nullptr;
}

/// Reads rows that are lines. If that fails after a row was cut, several rows may share a line, so that line
/// breaks mean nothing.
std::unique_ptr<TextReader> readText(const MeshFile& file, const PlyHeader& header, PlyContent content) {
  auto reader = std::make_unique<TextReader>(file, header, content, TextRows::Lines);
  try {
    reader->readElements();
  } catch (const Error&) {
    if (!reader->source().hasCutRows()) throw;
    if (auto values = readValues(file, header, content)) return values;
    reader->source().warnCutRows();
    throw;
  }
  reader->source().warnCutRows();
  return reader;
}

template <class Vec>
PlyReader<BinarySource, Vec> readBinary(const MeshFile& file, const PlyHeader& header, PlyContent content) {
  PlyReader<BinarySource, Vec> reader(file, header, content);
  reader.readElements();
  return reader;
}

}  // namespace

Mesh readPly(const MeshFile& file) {
  const PlyHeader header = readPlyHeader(file);
  constexpr PlyContent kMesh = PlyContent::Mesh;
  if (header.format == PlyFormat::Text) return readText(file, header, kMesh)->finish();
  return fitsFloat(header) ? readBinary<glm::vec3>(file, header, kMesh).finish()
                           : readBinary<glm::dvec3>(file, header, kMesh).finish();
}

std::vector<glm::dvec3> readPlyPoints(const MeshFile& file) {
  const PlyHeader header = readPlyHeader(file);
  constexpr PlyContent kPoints = PlyContent::Points;
  return header.format == PlyFormat::Text ? readText(file, header, kPoints)->takePositions()
                                          : readBinary<glm::dvec3>(file, header, kPoints).takePositions();
}

}  // namespace raymap
