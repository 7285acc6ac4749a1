#pragma once

// One reader and one writer per format, for `readPoints`, `writeQuery` and
// `writePointSamples`.

#include <raymap/query.h>
#include <raymap/sample_points.h>

#include <filesystem>
#include <iosfwd>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "io/mesh/mesh_file.h"

namespace raymap {

/// Reads columns x, y and z of a .csv, or the first three of any other text file. Throws `Error(Input)` that
/// names the line, the column and the value.
std::vector<glm::dvec3> readPointText(const MeshFile& file, std::string_view format = ".csv");
/// Reads an array whose last axis has length 3.
std::vector<glm::dvec3> readPointNpy(const SourceFile& source);

/// One quantity of a query, with a value per point.
struct PointArray {
  using Values = std::variant<std::span<const double>, std::span<const float>, std::span<const uint32_t>,
                              std::span<const glm::dvec3>>;

  std::string_view name;
  Values values;
  std::string_view parts = {};  ///< Letter or digit of each coordinate, e.g. "xyz".
};

/// Returns all arrays of a result, in its order, empty ones too.
std::vector<PointArray> arraysOf(const QueryResult& result);

/// Points, what is known about them, and a colour for each; no colours: not wanted.
struct PointTable {
  std::span<const glm::dvec3> points;
  std::vector<PointArray> arrays;
  std::vector<glm::u8vec3> colours;
};

void writePointCsv(std::ostream& out, const PointTable& table);
/// Writes the only array of the table, without the points.
void writePointNpy(std::ostream& out, const PointTable& table);
/// Writes all arrays of the table, without the points.
void writePointNpz(std::ostream& out, const PointTable& table);
void writePointPly(std::ostream& out, const PointTable& table);
/// Writes the rows of the points on both sides, and what they are relative to.
void writeSampleNpz(std::ostream& out, const PointSamples& samples);

}  // namespace raymap
