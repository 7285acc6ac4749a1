#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace raymap {

struct ZipStream;

/// Writes a zip file to a stream. Equal contents make equal files: all dates are 1 January 1980.
class ZipWriter {
 public:
  explicit ZipWriter(std::ostream& out);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  enum class Size : uint8_t { Any, Below4GiB };

  /// Begins a deflated file. Some programs do not read files that may have any size.
  void beginDeflated(const std::string& name, Size size);
  void write(std::string_view bytes);
  void endFile();

  /// Adds a file without compression: `header`, then `bytes`.
  void add(const std::string& name, const std::string& header, std::span<const std::byte> bytes);
  /// Writes the directory. Nothing may be added after that.
  void finish();

 private:
  void begin(const std::string& name, int level, Size size);
  void check(bool good) const;

  std::unique_ptr<ZipStream> stream_;
  void* zip_ = nullptr;
};

}  // namespace raymap
