#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/source_file.h"

struct zip;
struct zip_file;

namespace raymap {

/// Entry of a zip's directory.
struct ZipEntry {
  std::string name;
  uint64_t bytes = 0;  ///< Size of the content by the directory, which may lie.
};

/// Content of one entry, read from its beginning to its end.
class ZipContent {
 public:
  /// Reads up to `count` bytes, and fewer only at the end, where the checksum is compared. Throws
  /// `Error(Input)` if the content is damaged.
  size_t read(void* to, size_t count);

 private:
  friend class ZipReader;
  ZipContent(zip_file* file, const std::filesystem::path& path, std::string name);

  std::unique_ptr<zip_file, int (*)(zip_file*)> file_;
  const std::filesystem::path& path_;
  std::string name_;
};

/// Reads a zip. No bytes crash it. It keeps the directory in memory, and contents only in pieces.
class ZipReader {
 public:
  /// Reads the directory. Throws `Error(Input)` if it is damaged.
  explicit ZipReader(const SourceFile& source);
  /// Reads the directory of a zip in memory, which the reader refers to. The path is used in messages.
  ZipReader(std::span<const std::byte> bytes, std::filesystem::path path);

  /// Returns the entries in the order of the directory. Their names may be equal.
  const std::vector<ZipEntry>& entries() const { return entries_; }
  /// Returns the content of an entry, which refers to this reader. Throws `Error(Input)` if it is damaged,
  /// `Error(Unsupported)` if it is encrypted or neither stored nor deflated.
  ZipContent open(size_t entry) const;

 private:
  void readDirectory();

  std::filesystem::path path_;
  std::unique_ptr<zip, void (*)(zip*)> zip_;
  std::vector<ZipEntry> entries_;
};

}  // namespace raymap
