#pragma once

#include <raymap/error.h>
#include <raymap/field.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/memory.h"
#include "base/source_file.h"

namespace raymap {

/// Type of an array's elements. Distances are written as Float32, triangle indices as UInt32.
enum class ElementType : uint8_t { Float32, UInt32, Float64, Int32, Float16 };
size_t elementSize(ElementType type);

/// One of a field's arrays, ready to be written.
struct NamedArray {
  std::string_view name;
  ElementType type = ElementType::Float32;
  std::span<const std::byte> bytes;
};

/// Returns the name and the type of one of a field's arrays, without samples.
NamedArray describe(FieldArray array);
/// Returns the number of bytes of an array over a grid.
uint64_t arrayBytes(const Grid& grid, const NamedArray& array);
void writeBytes(std::ostream& out, std::span<const std::byte> bytes);

/// Returns the arrays that the field has, distance first.
std::vector<NamedArray> arraysOf(const Field& field);

/// Returns an array with its floats rounded to half floats, which `memory` holds. Whole numbers stay.
NamedArray halvesOf(const NamedArray& array, Buffer<uint16_t>& memory);

/// Returns the arrays that a file of several holds: all of the field with the distance, any other one alone.
std::vector<NamedArray> arraysWith(const Field& field, const NamedArray& asked);
/// Returns the largest magnitude of the finite values, or 0.
float largestMagnitude(std::span<const float> values);

/// Names of a field's arrays in files, in the order of `FieldArray`.
inline constexpr std::array<std::string_view, 4> kArrayNames{"distance", "winding", "confidence", "triangle"};
/// Returns whether a field has an array of this name.
bool isFieldArray(std::string_view name);

[[noreturn]] void throwInvalid(const std::filesystem::path& path, const std::string& what);
[[noreturn]] void throwUnsupported(const std::filesystem::path& path, const std::string& what);

/// A regular file. Its size is known before anything is read.
class InputFile {
 public:
  explicit InputFile(const SourceFile& source);

  const std::filesystem::path& path() const { return path_; }
  uint64_t remaining() const { return remaining_; }
  /// Reads exactly `count` bytes. Throws `Error(Input)` if the file is shorter.
  void read(void* to, size_t count);
  /// Returns the next line without its line end. Throws `Error(Input)` if it is longer than `longest` bytes.
  std::string readLine(size_t longest);

 private:
  std::filesystem::path path_;
  std::ifstream stream_;
  uint64_t remaining_ = 0;
};

/// Function that reads the next `count` bytes of an array, or throws.
using ReadBytes = std::function<void(void* to, size_t count)>;

/// Memory layout of an array in a file.
struct ArrayLayout {
  ElementType type = ElementType::Float32;
  bool bigEndian = false;
  bool zFastest = false;
};

/// Bytes of a file that hold samples.
struct StoredBytes {
  uint64_t count = 0;
  bool isDeflated = false;

  /// Returns the most bytes of samples that are read of them.
  uint64_t most() const { return isDeflated ? mostInflated(count) : count; }
};

/// Returns the number of samples. Throws `Error(Input)` if a side is not positive, or if the samples are more
/// than `stored` holds. Throws `Error(Memory)` if they do not fit in memory. Must be called before anything
/// is allocated.
size_t checkedSampleCount(const std::filesystem::path& path, const std::array<int64_t, 3>& dims,
                          ElementType type, const StoredBytes& stored);

/// Sets the grid's dimensions, which `checkedSampleCount` must have accepted.
void setDims(Grid& grid, const std::array<int64_t, 3>& dims);
/// Throws `Error(Input)` unless the spacing of samples is finite and positive.
void checkSpacing(const std::filesystem::path& path, double spacing);
/// Throws `Error(Input)` unless the grid is one (`placeProblem`), and `clampDistance` is finite and not
/// negative.
void checkPlacement(const std::filesystem::path& path, const Field& field);

/// Name of `Field::surfaceBounds` in files. Its numbers are x0 y0 z0 x1 y1 z1.
inline constexpr const char* kSurfaceBounds = "surface_bounds";
/// Name of `Field::clampDistance` in files, and in those that were written before it had that name.
inline constexpr const char* kClampDistance = "clamp_distance";
inline constexpr const char* kFormerClampDistance = "band";
/// Returns the numbers to store; the bounds must not be empty.
std::array<double, 6> surfaceBoundsOf(const Field& field);
/// Sets the bounds. Throws `Error(Input)` unless the numbers are finite and in order.
void setSurfaceBounds(const std::filesystem::path& path, std::span<const double> numbers, Field& field);

/// Reads the array into the field member called `name` and converts the elements to that member's type. An
/// unknown name means the triangles if the elements are integers, else the distance.
void readArray(const std::filesystem::path& path, Field& field, std::string_view name,
               const ArrayLayout& layout, const ReadBytes& read);

/// Reads numbers of the layout's type, in the order of the file.
void readReals(std::span<double> to, const ArrayLayout& layout, const ReadBytes& read);

/// Returns the shortest text that reads back as the same number, whatever the locale.
std::string toText(double value);
/// Returns the texts of numbers, separated by blanks.
std::string toText(std::span<const double> values);
/// Parses numbers separated by blanks, commas or parentheses. Returns nothing unless the text holds exactly
/// `count` numbers and nothing else.
std::optional<std::vector<double>> parseNumbers(std::string_view text, size_t count);
std::optional<std::array<int64_t, 3>> parseDims(std::string_view text);

}  // namespace raymap
