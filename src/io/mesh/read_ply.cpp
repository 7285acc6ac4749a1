// Stanford PLY: text and binary of both byte orders; faces as polygons or triangle strips; elements and
// properties in any order.

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>

#include "io/mesh/mesh_file.h"
#include "io/mesh/ply_header.h"
#include "io/mesh/text_scanner.h"

namespace raymap {

namespace {

static_assert(std::endian::native == std::endian::little);

/// Values of a text file.
class TextSource {
 public:
  TextSource(const MeshFile& file, const PlyHeader& header) : text_(file, header.bytes) {}

  double real(PlyType) { return text_.real(); }
  int64_t integer(PlyType) { return text_.integer(); }
  void skip(PlyType, uint64_t count) {
    for (; count > 0; --count)
      if (text_.word().empty()) text_.fail("the file ends too early");
  }

 private:
  TextScanner text_;
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
      default:
        return wholeNumber(real(type));
    }
  }

  void skip(PlyType type, uint64_t count) {
    need(count * plyTypeBytes(type));
    at_ += count * plyTypeBytes(type);
  }

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

  int64_t wholeNumber(double value) const {
    if (!(std::abs(value) <= 0x1p53) || value != std::floor(value))
      file_.fail("an index or a count is no whole number: " + std::to_string(value));
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

/// Reads the elements. `Vec` is single precision if the file has no more.
template <class Source, class Vec>
class PlyReader {
 public:
  PlyReader(const MeshFile& file, const PlyHeader& header)
      : file_(file), header_(header), source_(file, header) {}

  Mesh read() {
    if (!header_.find("vertex")) file_.fail("no 'vertex' element");
    if (!header_.find("face") && !header_.find("tristrips")) file_.fail("no 'face' or 'tristrips' element");
    for (const PlyElement& element : header_.elements) readElement(element);
    warnDropped(file_, dropped_);
    return finishMesh(file_, std::move(positions_), std::move(triangles_));
  }

 private:
  void readElement(const PlyElement& element) {
    if (element.name == "vertex")
      readVertices(element);
    else if (element.name == "face" || element.name == "tristrips")
      readFaces(element);
    else if (!element.properties.empty())
      for (uint64_t row = 0; row < element.count; ++row) skip(element.properties);
  }

  void readVertices(const PlyElement& element) {
    // Coordinate that each property sets; 3 for none.
    std::vector<int> target(element.properties.size(), 3);
    for (int c = 0; c < 3; ++c) {
      const int place = element.find(std::string_view("xyz").substr(static_cast<size_t>(c), 1));
      if (place < 0 || element.properties[static_cast<size_t>(place)].isList)
        file_.fail(std::string("the vertices have no property ") + "xyz"[c]);
      target[static_cast<size_t>(place)] = c;
    }
    positions_.reserve(element.count);
    for (uint64_t row = 0; row < element.count; ++row) {
      glm::vec<4, typename Vec::value_type> p;
      for (size_t i = 0; i < element.properties.size(); ++i) {
        const PlyProperty& property = element.properties[i];
        if (target[i] < 3)
          p[target[i]] = static_cast<typename Vec::value_type>(source_.real(property.type));
        else
          skip(property);
      }
      positions_.emplace_back(p);
    }
  }

  void readFaces(const PlyElement& element) {
    int list = element.find("vertex_indices");
    if (list < 0) list = element.find("vertex_index");
    if (list < 0 || !element.properties[static_cast<size_t>(list)].isList)
      file_.fail("element '" + element.name + "' has no list 'vertex_indices'");
    const bool areStrips = element.name == "tristrips";
    if (!areStrips) triangles_.reserve(element.count);
    for (uint64_t row = 0; row < element.count; ++row)
      for (size_t i = 0; i < element.properties.size(); ++i) {
        if (static_cast<int>(i) != list)
          skip(element.properties[i]);
        else if (areStrips)
          readStrips(element.properties[i], row);
        else
          readPolygon(element.properties[i], row);
      }
  }

  void readPolygon(const PlyProperty& list, uint64_t row) {
    const uint64_t count = readCount(list);
    corners_.clear();
    for (uint64_t i = 0; i < count; ++i) {
      const int64_t vertex = source_.integer(list.type);
      checkIndex(vertex, "face ", row);
      corners_.push_back(static_cast<uint32_t>(vertex));
    }
    if (count < 3) ++dropped_;
    appendFan(corners_, triangles_);
  }

  /// Reads a list of strips, each ended by -1 (2^32 - 1 in an unsigned type).
  void readStrips(const PlyProperty& list, uint64_t row) {
    const uint64_t count = readCount(list);
    corners_.clear();
    for (uint64_t i = 0; i < count; ++i) {
      const int64_t vertex = source_.integer(list.type);
      if (vertex == -1 || (list.type == PlyType::UInt32 && vertex == int64_t{UINT32_MAX})) {
        appendStrip(corners_, triangles_);
        corners_.clear();
        continue;
      }
      checkIndex(vertex, "triangle strip ", row);
      corners_.push_back(static_cast<uint32_t>(vertex));
    }
    appendStrip(corners_, triangles_);
  }

  void checkIndex(int64_t vertex, std::string_view what, uint64_t row) const {
    const uint64_t vertexCount = header_.find("vertex")->count;
    if (vertex < 0 || static_cast<uint64_t>(vertex) >= vertexCount)
      file_.fail(std::string(what) + std::to_string(row) + ": " + outOfRange(vertex, vertexCount));
  }

  uint64_t readCount(const PlyProperty& list) {
    const int64_t count = source_.integer(list.countType);
    if (count < 0 || static_cast<uint64_t>(count) > file_.bytes.size())
      file_.fail("a list '" + list.name + "' announces " + std::to_string(count) +
                 " values, but the file has " + counted(file_.bytes.size(), "byte"));
    return static_cast<uint64_t>(count);
  }

  void skip(const PlyProperty& property) {
    source_.skip(property.type, property.isList ? readCount(property) : 1);
  }
  void skip(const std::vector<PlyProperty>& row) {
    for (const PlyProperty& property : row) skip(property);
  }

  const MeshFile& file_;
  const PlyHeader& header_;
  Source source_;
  std::vector<Vec> positions_;
  std::vector<glm::uvec3> triangles_;
  std::vector<uint32_t> corners_;
  uint64_t dropped_ = 0;
};

/// Returns whether single precision holds the positions of the binary file exactly.
bool fitsFloat(const PlyHeader& header) {
  const PlyElement* vertex = header.find("vertex");
  return vertex && std::ranges::none_of(vertex->properties, [](const PlyProperty& property) {
           return property.type == PlyType::Double || property.type == PlyType::Int32 ||
                  property.type == PlyType::UInt32;
         });
}

}  // namespace

Mesh readPly(const MeshFile& file) {
  const PlyHeader header = readPlyHeader(file);
  if (header.format == PlyFormat::Text) return PlyReader<TextSource, glm::dvec3>(file, header).read();
  if (fitsFloat(header)) return PlyReader<BinarySource, glm::vec3>(file, header).read();
  return PlyReader<BinarySource, glm::dvec3>(file, header).read();
}

}  // namespace raymap
