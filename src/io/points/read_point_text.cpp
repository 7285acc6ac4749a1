// Points as text, a row each: CSV, and .xyz or .txt with blanks between the columns.

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>

#include "base/text.h"
#include "io/points/point_formats.h"

namespace raymap {

namespace {

using Fields = std::vector<std::string_view>;
using Columns = std::array<size_t, 3>;  // Indices of x, y and z.

constexpr std::string_view kBlanks = " \t";

std::string_view trimmed(std::string_view text) {
  const size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  text.remove_prefix(begin);
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

/// Goes through the rows: lines that are neither empty nor a comment.
class Rows {
 public:
  explicit Rows(std::string_view text) : rest_(text) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
  }

  bool next() {
    while (!rest_.empty()) {
      takeLine();
      if (!row_.empty() && !row_.starts_with('#') && !row_.starts_with("//")) return true;
    }
    return false;
  }
  std::string_view row() const { return row_; }
  /// Returns the number of the row's line, counted from 1.
  size_t line() const { return line_; }

 private:
  void takeLine() {
    const size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    row_ = trimmed(rest_.substr(0, end));
    rest_.remove_prefix(end);
    if (rest_.starts_with("\r\n")) rest_.remove_prefix(1);
    if (!rest_.empty()) rest_.remove_prefix(1);
    ++line_;
  }

  std::string_view rest_, row_;
  size_t line_ = 0;
};

/// Returns what separates the columns of a file with this row; a blank stands for any number of them.
char separatorOf(std::string_view row) {
  for (const char separator : {';', ','})
    if (row.find(separator) != row.npos) return separator;
  return ' ';
}

void split(std::string_view row, char separator, Fields& fields) {
  const std::string_view separators = separator == ' ' ? kBlanks : std::string_view(&separator, 1);
  fields.clear();
  while (true) {
    const size_t end = row.find_first_of(separators);
    std::string_view field = trimmed(row.substr(0, end));
    if (field.size() >= 2 && field.front() == '"' && field.back() == '"')
      field = field.substr(1, field.size() - 2);
    fields.push_back(field);
    if (end == row.npos) return;
    row.remove_prefix(end + 1);
    if (separator == ' ') row = trimmed(row);
  }
}

/// Returns a finite number, an infinity or NaN; nothing if the text is none or exceeds double precision.
std::optional<double> numberIn(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string listOf(const Fields& fields) {
  std::string text;
  for (const std::string_view field : fields)
    text.append(text.empty() ? "'" : ", '").append(field).append("'");
  return shortText(text);
}

class TextReader {
 public:
  TextReader(const MeshFile& file, bool isCsv) : file_(file), rows_(file.text()), isCsv_(isCsv) {}

  std::vector<glm::dvec3> read() {
    if (!rows_.next()) return {};
    separator_ = separatorOf(rows_.row());
    split(rows_.row(), separator_, fields_);
    firstLine_ = rows_.line();
    columnCount_ = fields_.size();
    const bool hasHeader =
        std::ranges::none_of(fields_, [](auto field) { return numberIn(field).has_value(); });
    const Columns columns = hasHeader ? namedColumns() : firstColumns();
    if (hasHeader && !rows_.next()) return {};
    std::vector<glm::dvec3> points;
    do points.push_back(readRow(columns));
    while (rows_.next());
    return points;
  }

 private:
  Columns namedColumns() const {
    Columns columns{};
    for (size_t c = 0; c < 3; ++c) {
      const auto isNamed = [&](std::string_view field) {
        return field.size() == 1 && std::tolower(static_cast<unsigned char>(field[0])) == "xyz"[c];
      };
      const auto found = std::ranges::find_if(fields_, isNamed);
      if (found == fields_.end())
        fail(std::string("no column is called ") + "xyz"[c] + ": the header names " + listOf(fields_) +
             "; call three columns x, y and z");
      columns[c] = static_cast<size_t>(found - fields_.begin());
    }
    return columns;
  }

  /// Columns of a file without a header. Other programs write normals or colours after the position, but not
  /// into a .csv.
  Columns firstColumns() const {
    if (columnCount_ < 3 || (isCsv_ && columnCount_ > 3))
      fail(counted(columnCount_, "column") + "; a row without a header holds x, y and z" +
           (isCsv_ ? "; add a header row that names the columns" : ""));
    return {0, 1, 2};
  }

  glm::dvec3 readRow(const Columns& columns) {
    split(rows_.row(), separator_, fields_);
    if (fields_.size() != columnCount_)
      fail(counted(fields_.size(), "column") + ", but line " + std::to_string(firstLine_) + " has " +
           std::to_string(columnCount_));
    glm::dvec3 point;
    for (int c = 0; c < 3; ++c) {
      const std::string_view field = fields_[columns[size_t(c)]];
      const std::optional<double> value = numberIn(field);
      if (!value)
        fail(std::string(1, "xyz"[c]) + " is " + excerpt(field) + ", which is not a number" +
             (field.empty() ? "; write nan for a point that is not known" : ""));
      point[c] = *value;
    }
    return point;
  }

  [[noreturn]] void fail(const std::string& what) const {
    file_.fail("line " + std::to_string(rows_.line()) + ": " + what);
  }

  const MeshFile& file_;
  Rows rows_;
  bool isCsv_ = false;
  Fields fields_;
  char separator_ = ',';
  size_t firstLine_ = 0, columnCount_ = 0;
};

}  // namespace

std::vector<glm::dvec3> readPointText(const MeshFile& file, std::string_view format) {
  return TextReader(file, format == ".csv").read();
}

}  // namespace raymap
