#pragma once

#include <cstddef>
#include <iosfwd>
#include <memory>
#include <span>
#include <string>

namespace raymap {

struct ZipStream;

/// Writes a zip file to a stream, without compression.
class ZipWriter {
 public:
  explicit ZipWriter(std::ostream& out);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// Adds a file: `header`, then `bytes`.
  void add(const std::string& name, const std::string& header, std::span<const std::byte> bytes);
  /// Writes the directory. Nothing may be added after that.
  void finish();

 private:
  void check(bool good) const;

  std::unique_ptr<ZipStream> stream_;
  void* zip_ = nullptr;
};

}  // namespace raymap
