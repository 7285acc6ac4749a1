#pragma once

#include <raymap/error.h>
#include <raymap/field.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raymap {

/// What an array is made of. The first is how distances are written, the second how triangles are.
enum class ElementType : uint8_t { Float32, UInt32, Float64, Int32 };
size_t elementSize(ElementType type);

/// One of a field's arrays, ready to be written.
struct NamedArray {
  std::string_view name;
  ElementType type = ElementType::Float32;
  std::span<const std::byte> bytes;
};

/// The arrays that the field has, distance first.
std::vector<NamedArray> arraysOf(const Field& field);

[[noreturn]] void throwInvalid(const std::filesystem::path& path, const std::string& what);
[[noreturn]] void throwUnsupported(const std::filesystem::path& path, const std::string& what);

/// A regular file whose size is known before anything is read.
class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  uint64_t remaining() const { return remaining_; }
  /// Reads exactly `count` bytes; throws `Error(Input)` if the file is shorter.
  void read(void* to, size_t count);
  /// The next line without its end; throws `Error(Input)` if it is longer than `longest`.
  std::string readLine(size_t longest);

 private:
  std::filesystem::path path_;
  std::ifstream stream_;
  uint64_t remaining_ = 0;
};

/// Gives the next `count` bytes of an array, or throws.
using ReadBytes = std::function<void(void* to, size_t count)>;

/// How an array lies in a file.
struct ArrayLayout {
  ElementType type = ElementType::Float32;
  bool bigEndian = false;
  bool zFastest = false;
};

/// The number of samples, or an `Error(Input)` if a side is not positive, or more bytes are declared than the
/// `available` ones could hold, and an `Error(Memory)` if they do not fit: nothing is allocated before this
/// has passed.
size_t checkedSampleCount(const std::filesystem::path& path, const std::array<int64_t, 3>& dims,
                          ElementType type, uint64_t available);
/// What a deflated stream of `bytes` can grow to at most (zlib's own bound is 1032 to 1).
uint64_t inflatedBound(uint64_t bytes);

/// Sets the grid's dimensions, which `checkedSampleCount` has passed.
void setDims(Grid& grid, const std::array<int64_t, 3>& dims);
/// Throws `Error(Input)` unless origin, spacing and band are finite, the spacing positive, the band not
/// negative.
void checkPlacement(const std::filesystem::path& path, const Field& field);

/// Reads the array of that name into the field, converted to the type that we hold. A name that is not ours
/// means the triangles if it holds whole numbers, else the distance.
void readArray(const std::filesystem::path& path, Field& field, std::string_view name,
               const ArrayLayout& layout, const ReadBytes& read);

/// The shortest text that reads back as the same number, whatever the locale.
std::string toText(double value);
/// Numbers separated by blanks, commas or brackets; nothing if there is anything else or they are not
/// `count`.
std::optional<std::vector<double>> parseNumbers(std::string_view text, size_t count);
std::optional<std::array<int64_t, 3>> parseDims(std::string_view text);

}  // namespace raymap
