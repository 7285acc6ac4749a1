#include "io/field/field_array.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>
#include <limits>
#include <ostream>

#include "base/memory.h"
#include "base/parallel.h"
#include "field/field_sampler.h"

namespace raymap {

static_assert(std::endian::native == std::endian::little, "the writers copy memory to little-endian files");

namespace {

template <class T>
NamedArray named(std::string_view name, ElementType type, const Buffer<T>& values) {
  return {name, type, std::as_bytes(std::span<const T>(values))};
}

template <class T>
void swapBytes(std::span<T> values) {
  for (T& value : values) {
    auto* bytes = reinterpret_cast<unsigned char*>(&value);
    std::reverse(bytes, bytes + sizeof(T));
  }
}

template <class T>
void readRaw(std::span<T> to, bool bigEndian, const ReadBytes& read) {
  read(to.data(), to.size_bytes());
  if (bigEndian) swapBytes(to);
}

/// Bits of a half float.
struct Half {
  uint16_t bits;
  explicit operator float() const { return glm::unpackHalf1x16(bits); }
  explicit operator double() const { return float(*this); }
};

/// Reads elements of type `From` piece by piece, without a second array for all of them.
template <class From, class To>
void readConverted(std::span<To> to, bool bigEndian, const ReadBytes& read) {
  constexpr size_t kPiece = size_t{1} << 16;
  std::vector<From> piece(std::min(kPiece, to.size()));
  for (size_t begin = 0; begin < to.size(); begin += kPiece) {
    const std::span<From> part(piece.data(), std::min(kPiece, to.size() - begin));
    readRaw(part, bigEndian, read);
    for (size_t i = 0; i < part.size(); ++i) to[begin + i] = static_cast<To>(part[i]);
  }
}

template <class T>
Buffer<T> transposed(const Buffer<T>& zFastest, glm::ivec3 dims) {
  Buffer<T> result(zFastest.size());
  const size_t nx = size_t(dims.x), ny = size_t(dims.y), nz = size_t(dims.z);
  for (size_t k = 0; k < nz; ++k)
    for (size_t j = 0; j < ny; ++j)
      for (size_t i = 0; i < nx; ++i) result[(k * ny + j) * nx + i] = zFastest[(i * ny + j) * nz + k];
  return result;
}

template <class Wide, class T>
Buffer<T> readBuffer(const Grid& grid, const ArrayLayout& layout, bool wide, const ReadBytes& read) {
  Buffer<T> values(grid.sampleCount());
  if (wide)
    readConverted<Wide, T>(values, layout.bigEndian, read);
  else
    readRaw<T>(values, layout.bigEndian, read);
  return layout.zFastest ? transposed(values, grid.dims) : std::move(values);
}

bool isSeparator(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ',' || c == '(' || c == ')';
}

/// Says why there are more samples than the bytes hold.
std::string overfull(const StoredBytes& stored) {
  if (!stored.isDeflated) return "more than its bytes can hold";
  return "but its " + std::to_string(stored.count) + " compressed bytes may stand for at most " +
         limitText(stored.most()) + "; write it uncompressed";
}

}  // namespace

size_t elementSize(ElementType type) {
  return type == ElementType::Float64 ? 8 : type == ElementType::Float16 ? 2 : 4;
}

NamedArray describe(FieldArray array) {
  const bool isTriangle = array == FieldArray::Triangle;
  return {kArrayNames[size_t(array)], isTriangle ? ElementType::UInt32 : ElementType::Float32};
}

uint64_t arrayBytes(const Grid& grid, const NamedArray& array) {
  return grid.sampleCount() * elementSize(array.type);
}

void writeBytes(std::ostream& out, std::span<const std::byte> bytes) {
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

std::vector<NamedArray> arraysOf(const Field& field) {
  std::vector<NamedArray> arrays{named("distance", ElementType::Float32, field.distance),
                                 named("winding", ElementType::Float32, field.winding),
                                 named("confidence", ElementType::Float32, field.confidence),
                                 named("triangle", ElementType::UInt32, field.triangle)};
  std::erase_if(arrays, [](const NamedArray& array) { return array.bytes.empty(); });
  return arrays;
}

NamedArray halvesOf(const NamedArray& array, Buffer<uint16_t>& memory) {
  if (array.type != ElementType::Float32) return array;
  const auto* values = reinterpret_cast<const float*>(array.bytes.data());
  memory.resizeUninitialized(array.bytes.size() / sizeof(float));
  parallelFor(memory.size(), kCheapGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) memory[i] = glm::packHalf1x16(values[i]);
  });
  return {array.name, ElementType::Float16, std::as_bytes(std::span<const uint16_t>(memory))};
}

std::vector<NamedArray> arraysWith(const Field& field, const NamedArray& asked) {
  return asked.name == "distance" ? arraysOf(field) : std::vector<NamedArray>{asked};
}

bool isFieldArray(std::string_view name) {
  return std::ranges::find(kArrayNames, name) != kArrayNames.end();
}

void throwInvalid(const std::filesystem::path& path, const std::string& what) {
  throw Error(ErrorCode::Input, path.string() + ": " + what);
}

void throwUnsupported(const std::filesystem::path& path, const std::string& what) {
  throw Error(ErrorCode::Unsupported, path.string() + ": " + what);
}

InputFile::InputFile(const SourceFile& source) : path_(source.path()) {
  const std::filesystem::path& path = source.path();
  std::error_code error;
  const auto status = std::filesystem::status(source.place(), error);
  if (!std::filesystem::exists(status))
    throw Error(ErrorCode::File, path.string() + ": no such file; check the path");
  if (!std::filesystem::is_regular_file(status))
    throw Error(ErrorCode::File, path.string() + ": not a regular file; arrays cannot be read from it");
  stream_.open(source.place(), std::ios::binary);
  remaining_ = std::filesystem::file_size(source.place(), error);
  if (!stream_ || error)
    throw Error(ErrorCode::File, path.string() + ": cannot be opened; check its permissions");
}

void InputFile::read(void* to, size_t count) {
  if (count > remaining_)
    throwInvalid(path_, "ends early: " + std::to_string(count - remaining_) + " bytes are missing");
  if (!stream_.read(static_cast<char*>(to), static_cast<std::streamsize>(count)))
    throw Error(ErrorCode::File, path_.string() + ": cannot be read to its end");
  remaining_ -= count;
}

std::string InputFile::readLine(size_t longest) {
  std::string line;
  for (char c = 0; remaining_ > 0;) {
    read(&c, 1);
    if (c == '\n') break;
    if (line.size() == longest) throwInvalid(path_, "a header line is longer than any of this format");
    line += c;
  }
  if (line.ends_with('\r')) line.pop_back();
  return line;
}

size_t checkedSampleCount(const std::filesystem::path& path, const std::array<int64_t, 3>& dims,
                          ElementType type, const StoredBytes& stored) {
  uint64_t room = stored.most() / elementSize(type);
  uint64_t count = 1;
  for (const int64_t side : dims) {
    if (side < 1 || side > std::numeric_limits<int>::max())
      throwInvalid(path, "a grid of " + std::to_string(side) + " samples along one side makes no sense");
    count *= static_cast<uint64_t>(side);
    room /= static_cast<uint64_t>(side);
    if (room == 0)
      throwInvalid(path, "declares " + std::to_string(dims[0]) + " x " + std::to_string(dims[1]) + " x " +
                             std::to_string(dims[2]) + " samples, " + overfull(stored));
  }
  const uint64_t bytes = count * elementSize(type), left = memoryLeft();
  if (bytes > left)
    throw Error(ErrorCode::Memory, path.string() + ": its samples need " + neededText(bytes) + ", and only " +
                                       limitText(left) + " are available");
  return count;
}

void setDims(Grid& grid, const std::array<int64_t, 3>& dims) {
  grid.dims = {static_cast<int>(dims[0]), static_cast<int>(dims[1]), static_cast<int>(dims[2])};
}

void checkSpacing(const std::filesystem::path& path, double spacing) {
  if (!std::isfinite(spacing) || spacing <= 0.0)
    throwInvalid(path, "the grid's spacing is " + toText(spacing) + ", not a positive number");
}

void checkPlacement(const std::filesystem::path& path, const Field& field) {
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(field.grid.origin[axis]))
      throwInvalid(path, "the grid's origin is not finite: " + std::string(1, "xyz"[axis]) + " = " +
                             toText(field.grid.origin[axis]));
  checkSpacing(path, field.grid.spacing);
  if (const std::string problem = placeProblem(field.grid); !problem.empty()) throwInvalid(path, problem);
  if (!std::isfinite(field.clampDistance) || field.clampDistance < 0.0)
    throwInvalid(path, std::string("its ") + kClampDistance + " is " + toText(field.clampDistance) +
                           ", not a distance");
}

std::array<double, 6> surfaceBoundsOf(const Field& field) {
  const auto& [low, high] = field.surfaceBounds;
  return {low.x, low.y, low.z, high.x, high.y, high.z};
}

void setSurfaceBounds(const std::filesystem::path& path, std::span<const double> numbers, Field& field) {
  const Box box{{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}};
  const bool areFinite = std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
  if (!areFinite || box.isEmpty())
    throwInvalid(path, std::string("its ") + kSurfaceBounds + " are not x0 y0 z0 x1 y1 z1 in order");
  field.surfaceBounds = box;
}

void readArray(const std::filesystem::path& path, Field& field, std::string_view name,
               const ArrayLayout& layout, const ReadBytes& read) {
  const bool isWhole = layout.type == ElementType::UInt32 || layout.type == ElementType::Int32;
  if (isFieldArray(name) && isWhole != (name == "triangle"))
    throwInvalid(path, "the array '" + std::string(name) + "' has elements of the wrong type");
  if (isWhole) {
    field.triangle = readBuffer<uint32_t, uint32_t>(field.grid, layout, false, read);
    return;
  }
  Buffer<float>& values = name == "winding"      ? field.winding
                          : name == "confidence" ? field.confidence
                                                 : field.distance;
  if (layout.type == ElementType::Float16)
    values = readBuffer<Half, float>(field.grid, layout, true, read);
  else
    values = readBuffer<double, float>(field.grid, layout, layout.type == ElementType::Float64, read);
}

void readReals(std::span<double> to, const ArrayLayout& layout, const ReadBytes& read) {
  switch (layout.type) {
    case ElementType::Float32:
      return readConverted<float>(to, layout.bigEndian, read);
    case ElementType::UInt32:
      return readConverted<uint32_t>(to, layout.bigEndian, read);
    case ElementType::Int32:
      return readConverted<int32_t>(to, layout.bigEndian, read);
    case ElementType::Float16:
      return readConverted<Half>(to, layout.bigEndian, read);
    case ElementType::Float64:
      return readRaw(to, layout.bigEndian, read);
  }
}

std::string toText(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string toText(std::span<const double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + toText(value);
  return text;
}

std::optional<std::vector<double>> parseNumbers(std::string_view text, size_t count) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    while (at != end && isSeparator(*at)) ++at;
    if (at == end) break;
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || numbers.size() == count) return std::nullopt;
    numbers.push_back(value);
    at = next;
  }
  if (numbers.size() != count) return std::nullopt;
  return numbers;
}

std::optional<std::array<int64_t, 3>> parseDims(std::string_view text) {
  const auto numbers = parseNumbers(text, 3);
  std::array<int64_t, 3> dims{};
  for (size_t axis = 0; numbers && axis < 3; ++axis) {
    const double side = (*numbers)[axis];
    if (!(std::abs(side) <= 0x1p53) || side != std::trunc(side)) return std::nullopt;
    dims[axis] = static_cast<int64_t>(side);
  }
  if (!numbers) return std::nullopt;
  return dims;
}

float largestMagnitude(std::span<const float> values) {
  float largest = 0.0F;
  for (const float value : values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest;
}

}  // namespace raymap
