#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <raymap/io.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <utility>

#include "io/file_format.h"
#include "io/points/point_formats.h"
#include "picture/colour.h"

namespace raymap {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 5> kPointExtensions{".csv", ".npy", ".ply", ".xyz", ".txt"};

struct PointFormat {
  std::string_view extension;
  void (*write)(std::ostream& out, const PointTable& table);
  bool goesBack = false;  ///< Whether the writer goes back in its stream.
};

constexpr std::array kPointFormats{PointFormat{".csv", writePointCsv}, PointFormat{".npy", writePointNpy},
                                   PointFormat{".npz", writePointNpz, true},
                                   PointFormat{".ply", writePointPly}};

[[noreturn]] void failExtension(const fs::path& path, const std::string& what,
                                const std::vector<std::string>& known) {
  throw Error(ErrorCode::Usage, path.string() + ": '" + path.extension().string() + "' is not a format for " +
                                    what + "; use one of " + listOf(known));
}

const PointFormat& findFormat(const fs::path& path, std::string_view extension) {
  const auto* found = std::ranges::find(kPointFormats, extension, &PointFormat::extension);
  if (found == kPointFormats.end()) failExtension(path, "the results of a query", queryExtensions());
  return *found;
}

size_t sizeOf(const PointArray& array) {
  return std::visit([](const auto& values) { return values.size(); }, array.values);
}

void check(const fs::path& path, const PointFormat& format, const PointTable& table) {
  const auto require = [&](bool holds, const char* what) {
    if (!holds) throw Error(ErrorCode::Usage, path.string() + ": " + what);
  };
  require(!table.arrays.empty(), "there are no results to write");
  require(format.extension != ".npy" || table.arrays.size() == 1,
          "a .npy holds one array; ask for one, or write a .npz");
  for (const PointArray& array : table.arrays)
    require(sizeOf(array) == table.points.size(), "the results are those of another number of points");
}

glm::u8vec3 encoded(const Colour& colour) {
  return glm::u8vec3(
      glm::round(255.0 * glm::dvec3(encodeSrgb(colour.r), encodeSrgb(colour.g), encodeSrgb(colour.b))));
}

/// Returns the colours of a slice: each side of the surface is deepest at its largest distance.
template <class Number>
std::vector<glm::u8vec3> coloursOf(std::span<const Number> distances) {
  double inside = 0.0, outside = 0.0;
  for (const double distance : distances) {
    if (!std::isfinite(distance)) continue;
    inside = std::max(inside, -distance);
    outside = std::max(outside, distance);
  }
  std::vector<glm::u8vec3> colours;
  colours.reserve(distances.size());
  for (const double distance : distances)
    colours.push_back(encoded(
        std::isfinite(distance) ? distanceColour(distance, distance < 0.0 ? inside : outside) : kNotFinite));
  return colours;
}

template <class Number>
void writeTable(const fs::path& path, PointTable table, std::span<const Number> distances,
                const QueryWriteOptions& options) {
  const PointFormat& format = findFormat(path, formatOf(path, options.format, queryExtensions()));
  const bool isEmpty = table.points.empty();
  std::erase_if(table.arrays, [&](const PointArray& array) {
    return sizeOf(array) == 0 && !(isEmpty && std::ranges::count(options.arrays, array.name) > 0);
  });
  check(path, format, table);
  if (options.colour) {
    if (format.extension != ".ply" || (distances.empty() && !isEmpty))
      throw Error(ErrorCode::Usage, path.string() + ": colours need distances and a .ply");
    table.colours = coloursOf(distances);
  }
  const auto write = [&](std::ostream& out) { format.write(out, table); };
  writeAtomically(path, [&](std::ostream& out) { format.goesBack ? writeSeekable(out, write) : write(out); });
}

}  // namespace

std::vector<std::string> pointExtensions() {
  return {kPointExtensions.begin(), kPointExtensions.end()};
}

std::vector<std::string> queryExtensions() {
  std::vector<std::string> extensions;
  for (const PointFormat& format : kPointFormats) extensions.emplace_back(format.extension);
  return extensions;
}

std::vector<std::string> sampleExtensions() {
  return {".npz", ".csv", ".ply"};
}

std::vector<glm::dvec3> readPoints(const fs::path& path, const ReadOptions& options) {
  const SourceFile source(path);
  const std::string format = formatOf(source, options.format, pointExtensions());
  if (!contains(pointExtensions(), format)) failExtension(path, "points", pointExtensions());
  if (format == ".npy") return readPointNpy(source);
  const Buffer<std::byte> bytes = loadFile(source);
  const MeshFile file{bytes, path, options.warn};
  if (format != ".ply") return readPointText(file, format);
  return readPlyPoints(file);
}

void writeQuery(const fs::path& path, std::span<const glm::dvec3> points, const QueryResult& result,
                const QueryWriteOptions& options) {
  writeTable(path, {points, arraysOf(result), {}}, std::span<const double>(result.distance), options);
}

void writeSamples(const fs::path& path, std::span<const glm::dvec3> points, const Samples& samples,
                  const QueryWriteOptions& options) {
  const std::span<const float> distance = samples.distance;
  const std::vector<glm::dvec3> gradient(samples.gradient.begin(), samples.gradient.end());
  const std::span<const glm::dvec3> gradients = gradient;
  writeTable(path, {points, {{"distance", distance}, {"gradient", gradients, "xyz"}}, {}}, distance, options);
}

void writePointSamples(const fs::path& path, const PointSamples& samples, std::string_view given) {
  const std::string format = formatOf(path, given, sampleExtensions());
  if (!contains(sampleExtensions(), format)) failExtension(path, "points with distances", sampleExtensions());
  const std::span<const double> distance = samples.distance;
  const std::span<const glm::dvec3> gradient = samples.gradient;
  const PointTable table{samples.points, {{"distance", distance}, {"gradient", gradient, "xyz"}}, {}};
  writeAtomically(path, [&](std::ostream& out) {
    if (format == ".npz")
      writeSeekable(out, [&](std::ostream& file) { writeSampleNpz(file, samples); });
    else
      (format == ".csv" ? writePointCsv : writePointPly)(out, table);
  });
}

}  // namespace raymap
