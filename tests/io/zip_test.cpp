// Zips with contents and places above 4 GiB. What is not zero takes the disk's space, and nothing takes
// memory.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <raymap/error.h>
#include <raymap/io.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <ostream>
#include <sstream>
#include <streambuf>

#include "error_code.h"
#include "files.h"
#include "io/zip/zip_reader.h"
#include "io/zip/zip_writer.h"
#include "zip_file.h"

namespace raymap {
namespace {

using namespace samples;
using Members = std::vector<std::pair<std::string, std::string>>;

constexpr size_t kPiece = size_t{1} << 16;

bool isZero(const char* bytes, size_t count) {
  static const std::array<char, kPiece> kZeros{};
  for (; count > kPiece; bytes += kPiece, count -= kPiece)
    if (std::memcmp(bytes, kZeros.data(), kPiece) != 0) return false;
  return std::memcmp(bytes, kZeros.data(), count) == 0;
}

/// A file in which zeros take no space.
class SparseFile : public std::streambuf {
 public:
  explicit SparseFile(const std::filesystem::path& path)
      : descriptor_(open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600)) {}
  ~SparseFile() override { close(descriptor_); }

 protected:
  std::streamsize xsputn(const char* data, std::streamsize count) override {
    const auto bytes = static_cast<size_t>(count);
    end_ = std::max(end_, at_ + count);
    const bool good = isZero(data, bytes) ? ftruncate(descriptor_, end_) == 0
                                          : pwrite(descriptor_, data, bytes, at_) == ssize_t(bytes);
    at_ += count;
    return good ? count : 0;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    at_ = offset + (from == std::ios_base::beg ? 0 : from == std::ios_base::cur ? at_ : end_);
    return at_;
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override {
    return seekoff(position, std::ios_base::beg, mode);
  }

 private:
  int descriptor_;
  off_t at_ = 0, end_ = 0;
};

/// Zeros that take no memory until they are written.
class Zeros {
 public:
  explicit Zeros(size_t size)
      : size_(size),
        bytes_(static_cast<std::byte*>(mmap(nullptr, size, PROT_READ | PROT_WRITE,
                                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0))) {}
  ~Zeros() { munmap(bytes_, size_); }
  Zeros(const Zeros&) = delete;
  Zeros& operator=(const Zeros&) = delete;
  std::span<std::byte> span() const { return {bytes_, size_}; }

 private:
  size_t size_;
  std::byte* bytes_;
};

std::string contentOf(const ZipReader& zip, size_t entry) {
  std::string content(zip.entries()[entry].bytes, '\0');
  ZipContent file = zip.open(entry);
  EXPECT_EQ(file.read(content.data(), content.size()), content.size());
  char rest = 0;
  EXPECT_EQ(file.read(&rest, 1), 0u);
  return content;
}

/// Returns the .npy file of a grid of 2 x 1 x 1 samples.
std::string twoSamples(float first, float second) {
  std::string header = "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 1, 1), }";
  header.resize(117, ' ');
  return std::string("\x93NUMPY\x01\x00", 8) + raw(uint16_t{118}) + header + "\n" +
         raw<float>({first, second});
}

TEST(Zip, KeepsContents) {
  std::ostringstream out;
  ZipWriter writer(out);
  const std::string bytes(100'000, 'b'), nothing;
  writer.add("stored", "header", std::as_bytes(std::span(bytes)));
  writer.add("header alone", "header", {});
  writer.add("empty", "", std::as_bytes(std::span(nothing)));
  const std::array<std::string, 4> pieces{"one, ", "", std::string(300'000, 't'), "three"};
  writer.addDeflated("deflated", pieces.size(), [&](size_t i) { return pieces[i]; });
  writer.finish();
  const std::string zip = out.str();
  EXPECT_LT(zip.size(), bytes.size() + 3000);

  const ZipReader reader(std::as_bytes(std::span(zip)), "a.zip");
  ASSERT_EQ(reader.entries().size(), 4u);
  EXPECT_EQ(reader.entries()[0].name, "stored");
  EXPECT_EQ(contentOf(reader, 0), "header" + bytes);
  EXPECT_EQ(contentOf(reader, 1), "header");
  EXPECT_EQ(contentOf(reader, 2), "");
  EXPECT_EQ(contentOf(reader, 3), "one, " + pieces[2] + "three");
}

TEST(Zip, LetsExceptionsThrough) {
  std::ostringstream out;
  ZipWriter writer(out);
  EXPECT_THROW(
      writer.addDeflated("a", 1, [](size_t) -> std::string { throw Error(ErrorCode::Cancelled, "stop"); }),
      Error);
  int calls = 0;
  writer.addDeflated("b", 1, [&](size_t) -> std::string {
    if (++calls == 2) throw Error(ErrorCode::Cancelled, "stop");
    return "text";
  });
  EXPECT_EQ(codeOf([&] { writer.finish(); }), ErrorCode::Cancelled);
}

TEST(Zip, NeedsAStreamThatGoesBack) {
  class Pipe : public std::streambuf {
    int_type overflow(int_type c) override { return c; }
  } pipe;
  std::ostream out(&pipe);
  ZipWriter writer(out);
  writer.add("a", "text", {});
  EXPECT_EQ(codeOf([&] { writer.finish(); }), ErrorCode::File);
}

TEST(Zip, KeepsMoreThan4GiB) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "a.npz";
  const Zeros zeros((size_t{1} << 32) + (size_t{1} << 20));
  zeros.span().back() = std::byte{7};
  {
    SparseFile file(path);
    std::ostream out(&file);
    ZipWriter writer(out);
    writer.add("notes.npy", "header", zeros.span());
    writer.add("distance.npy", twoSamples(-1.5f, 2.5f), {});
    writer.finish();
  }
  EXPECT_EQ(readField(path).distance[1], 2.5f) << "notes are not read";
  const ZipReader reader{SourceFile(path)};
  ASSERT_EQ(reader.entries().size(), 2u);
  EXPECT_EQ(reader.entries()[0].bytes, 6 + zeros.span().size());
  EXPECT_EQ(contentOf(reader, 1), twoSamples(-1.5f, 2.5f));

  ZipContent large = reader.open(0);
  std::vector<char> piece(size_t{1} << 20);
  ASSERT_EQ(large.read(piece.data(), 6), 6u);
  EXPECT_EQ(std::string(piece.data(), 6), "header");
  const size_t last = zeros.span().size() - piece.size();
  for (size_t at = 0; at < last; at += piece.size()) {
    ASSERT_EQ(large.read(piece.data(), piece.size()), piece.size());
    ASSERT_TRUE(isZero(piece.data(), piece.size())) << at;
  }
  ASSERT_EQ(large.read(piece.data(), piece.size()), piece.size());
  EXPECT_TRUE(isZero(piece.data(), piece.size() - 1));
  EXPECT_EQ(piece.back(), 7);
  EXPECT_EQ(large.read(piece.data(), 1), 0u) << "and the checksum is right";
}

TEST(Zip, HoldsTheClampDistanceUnderEitherName) {
  const std::string header = "{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }\n";
  const std::string number = std::string("\x93NUMPY\x01\x00", 8) + raw(static_cast<uint16_t>(header.size())) +
                             header + raw<double>({0.75});
  for (const std::string name : {"clamp_distance.npy", "band.npy"}) {
    const TemporaryFile file("a.npz", zipFile({{"distance.npy", twoSamples(-0.75f, 0.5f)}, {name, number}}));
    EXPECT_EQ(readField(file.path()).clampDistance, 0.75) << name;
  }
}

// NumPy writes fields of 64 bits for arrays of 2 GiB and more.
TEST(Zip, ReadsFieldsWhoseSizesHave64Bits) {
  const std::string origin = "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }\n";
  const Members members{
      {"distance.npy", twoSamples(-1.5f, 2.5f)},
      {"winding.npy", twoSamples(1.0f, 0.25f)},
      {"origin.npy", std::string("\x93NUMPY\x01\x00", 8) + raw(static_cast<uint16_t>(origin.size())) +
                         origin + raw<double>({1, 2, 3})}};
  const TemporaryFile file("a.npz", zipFile(members, Zip::StoredIn64Bits));
  const Field field = readField(file.path());
  EXPECT_EQ(field.grid.dims, glm::ivec3(2, 1, 1));
  EXPECT_EQ(field.distance[0], -1.5f);
  EXPECT_EQ(field.distance[1], 2.5f);
  EXPECT_EQ(field.winding[1], 0.25f);
  EXPECT_EQ(field.grid.origin, glm::dvec3(1, 2, 3));
}

}  // namespace
}  // namespace raymap
