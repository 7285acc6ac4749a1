#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace raymap {

/// A file to read. What comes through a pipe is read to its end at once and kept in memory: it then has a
/// size, and can be read from any position and more than once.
class SourceFile {
 public:
  /// Throws `Error(File)` if a pipe cannot be read, `Error(Memory)` if it holds more than half of the
  /// machine's memory. Whether there is a file at the path shows when it is opened.
  explicit SourceFile(std::filesystem::path path);
  ~SourceFile();
  SourceFile(const SourceFile&) = delete;
  SourceFile& operator=(const SourceFile&) = delete;

  /// Returns the path that the user gave, for messages.
  const std::filesystem::path& path() const { return path_; }
  /// Returns the path at which to open the file. Child processes can open it too.
  const std::filesystem::path& place() const { return place_; }
  /// Returns the folder in which files are looked for that this one names. For a pipe: the current one.
  std::filesystem::path folder() const;
  /// Returns up to `bytes` bytes from the beginning; none if the file cannot be read.
  std::string head(size_t bytes) const;

 private:
  void copy();

  std::filesystem::path path_, place_;
  int copy_ = -1;  ///< Descriptor of the copy in memory.
};

/// Returns half of the machine's memory, the most bytes that a file may have to be read.
uint64_t mostFileBytes();

/// Returns the open descriptor that a path such as /dev/stdin or /dev/fd/5 names, or -1.
int namedDescriptor(const std::filesystem::path& path);

}  // namespace raymap
