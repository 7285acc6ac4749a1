#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>

struct zip;
struct zip_source;

namespace raymap {

/// Writes a zip to a stream that can go back. Equal contents make equal bytes: all dates are 1 January 1980.
class ZipWriter {
 public:
  explicit ZipWriter(std::ostream& out);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// Adds a file that is not compressed: `header`, then `bytes`, to which the writer refers until `finish`.
  void add(const std::string& name, std::string header, std::span<const std::byte> bytes);
  /// Adds a deflated file of `count` pieces. `piece` returns one of them. Each is asked for twice: first for
  /// the size of all, which says whether the zip needs fields of 64 bits.
  void addDeflated(const std::string& name, size_t count, std::function<std::string(size_t index)> piece);
  /// Writes all files and the directory. Nothing may be added after that.
  void finish();

 private:
  void addSource(const std::string& name, zip_source* source, int method);
  void check(bool good) const;

  std::exception_ptr problem_;  ///< First exception that a callback of libzip could not let through.
  zip* zip_ = nullptr;
};

}  // namespace raymap
