// Writes the results of a query as CSV, NumPy arrays, or the vertices of a PLY.

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <ostream>
#include <type_traits>

#include "io/field/npy.h"
#include "io/mesh/mesh_formats.h"
#include "io/points/point_formats.h"
#include "io/zip/zip_writer.h"

namespace raymap {

namespace {

template <class T>
constexpr bool kIsVector = std::is_same_v<T, glm::dvec3>;

/// Collects bytes and writes them in large pieces.
class TextPieces {
 public:
  explicit TextPieces(std::ostream& out) : out_(out) {}

  void add(char c) { bytes_ += c; }
  void add(std::string_view text) { bytes_ += text; }
  /// Adds the shortest text that reads back as the same number. NaN has no sign, and no triangle is -1.
  template <class T>
  void addNumber(T value) {
    if constexpr (std::is_floating_point_v<T>) {
      if (std::isnan(value)) return add("nan");
    } else {
      if (value == kNoTriangle) return add("-1");
    }
    std::array<char, 32> text{};
    add({text.data(), static_cast<size_t>(std::to_chars(text.data(), text.data() + text.size(), value).ptr -
                                          text.data())});
  }
  template <class T>
  void addBytes(const T& value) {
    std::array<char, sizeof(T)> raw{};
    append(raw.data(), value);
    add({raw.data(), raw.size()});
  }
  /// Ends a row.
  void endRow() {
    constexpr size_t kPiece = size_t{1} << 16;
    if (bytes_.size() >= kPiece) write();
  }
  void write() {
    out_.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
    bytes_.clear();
  }

 private:
  std::ostream& out_;
  std::string bytes_;
};

std::string nameOf(const PointArray& array, size_t part) {
  return std::string(array.name) + (array.parts.empty() ? "" : std::string("_") + array.parts[part]);
}

template <class Element>
NpyHeader headerOf(std::span<const Element> values) {
  const auto count = static_cast<int64_t>(values.size());
  if constexpr (kIsVector<Element>) return {"<f8", false, {count, 3}};
  if constexpr (std::is_same_v<Element, double>) return {"<f8", false, {count}};
  if constexpr (std::is_same_v<Element, float>) return {"<f4", false, {count}};
  return {"<u4", false, {count}};
}

void addColumns(TextPieces& pieces, const PointArray& array, size_t point) {
  std::visit(
      [&](const auto& values) {
        if constexpr (kIsVector<std::remove_cvref_t<decltype(values[0])>>) {
          for (int c = 0; c < 3; ++c) {
            pieces.add(',');
            pieces.addNumber(values[point][c]);
          }
        } else {
          pieces.add(',');
          pieces.addNumber(values[point]);
        }
      },
      array.values);
}

/// A .ply holds positions in double precision, all other numbers in single precision.
bool isPosition(const PointArray& array) {
  return array.name == "closest";
}

void declareProperties(std::ostream& out, const PointArray& array) {
  const bool isWhole = std::holds_alternative<std::span<const uint32_t>>(array.values);
  const char* const type = isWhole ? "uint" : isPosition(array) ? "double" : "float";
  for (size_t part = 0; part < std::max<size_t>(array.parts.size(), 1); ++part)
    out << "property " << type << ' ' << nameOf(array, part) << '\n';
}

void addProperties(TextPieces& pieces, const PointArray& array, size_t point) {
  std::visit(
      [&](const auto& values) {
        using Element = std::remove_cvref_t<decltype(values[0])>;
        if constexpr (std::is_same_v<Element, double>) {
          pieces.addBytes(static_cast<float>(values[point]));
        } else if constexpr (kIsVector<Element>) {
          if (isPosition(array))
            pieces.addBytes(values[point]);
          else
            pieces.addBytes(glm::vec3(values[point]));
        } else {
          pieces.addBytes(values[point]);
        }
      },
      array.values);
}

}  // namespace

std::vector<PointArray> arraysOf(const QueryResult& result) {
  std::vector<PointArray> arrays;
  const auto add = [&](std::string_view name, const auto& buffer, std::string_view parts = "") {
    arrays.push_back({name, std::span(buffer.data(), buffer.size()), parts});
  };
  add("distance", result.distance);
  add("closest", result.closest, "xyz");
  add("triangle", result.triangle);
  add("barycentric", result.barycentric, "012");
  add("direction", result.direction, "xyz");
  add("winding", result.winding);
  add("confidence", result.confidence);
  return arrays;
}

void writePointCsv(std::ostream& out, const PointTable& table) {
  out << "x,y,z";
  for (const PointArray& array : table.arrays)
    for (size_t part = 0; part < std::max<size_t>(array.parts.size(), 1); ++part)
      out << ',' << nameOf(array, part);
  out << '\n';
  TextPieces pieces(out);
  for (size_t i = 0; i < table.points.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      if (c > 0) pieces.add(',');
      pieces.addNumber(table.points[i][c]);
    }
    for (const PointArray& array : table.arrays) addColumns(pieces, array, i);
    pieces.add('\n');
    pieces.endRow();
  }
  pieces.write();
}

void writePointNpy(std::ostream& out, const PointTable& table) {
  std::visit(
      [&](const auto& values) {
        out << npyHeader(headerOf(values));
        out.write(reinterpret_cast<const char*>(values.data()),
                  static_cast<std::streamsize>(values.size_bytes()));
      },
      table.arrays.front().values);
}

void writePointNpz(std::ostream& out, const PointTable& table) {
  ZipWriter zip(out);
  for (const PointArray& array : table.arrays)
    std::visit(
        [&](const auto& values) {
          zip.add(std::string(array.name) + ".npy", npyHeader(headerOf(values)), std::as_bytes(values));
        },
        array.values);
  zip.finish();
}

void writePointPly(std::ostream& out, const PointTable& table) {
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << table.points.size()
      << "\nproperty double x\nproperty double y\nproperty double z\n";
  for (const PointArray& array : table.arrays) declareProperties(out, array);
  if (!table.colours.empty()) out << "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  out << "end_header\n";
  TextPieces pieces(out);
  for (size_t i = 0; i < table.points.size(); ++i) {
    pieces.addBytes(table.points[i]);
    for (const PointArray& array : table.arrays) addProperties(pieces, array, i);
    if (!table.colours.empty()) pieces.addBytes(table.colours[i]);
    pieces.endRow();
  }
  pieces.write();
}

void writeSampleNpz(std::ostream& out, const PointSamples& samples) {
  ZipWriter zip(out);
  const auto add = [&](const std::string& name, const NpyHeader& header, std::span<const std::byte> bytes) {
    zip.add(name + ".npy", npyHeader(header), bytes);
  };
  const auto addRows = [&](const std::string& name, const SampleRows& rows) {
    std::visit(
        [&](const auto& values) {
          const char* const type = sizeof(values[0]) == sizeof(glm::vec4) ? "<f4" : "<f8";
          add(name, {type, false, {int64_t(values.size()), 4}}, std::as_bytes(std::span(values)));
        },
        rows);
  };
  const SampleRows outside = sampleRows(samples, false), inside = sampleRows(samples, true);
  addRows("pos", outside);
  addRows("neg", inside);
  add("centre", {"<f8", false, {3}}, std::as_bytes(std::span(&samples.centre, 1)));
  add("scale", {"<f8", false, {}}, std::as_bytes(std::span(&samples.scale, 1)));
  zip.finish();
}

}  // namespace raymap
