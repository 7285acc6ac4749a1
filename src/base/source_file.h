#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace raymap {

/// A file to read. What comes through a pipe is read to its end at once and kept in memory: it then has a
/// size, and can be read from any position and more than once.
class SourceFile {
 public:
  /// Throws `Error(File)` if a pipe cannot be read, `Error(Memory)` if it holds more than
  /// `mostFileBytes`. Whether there is a file at the path shows when it is opened.
  explicit SourceFile(std::filesystem::path path);
  /// Keeps bytes in memory as the content of a file that exists nowhere else; `path` is for messages.
  SourceFile(std::filesystem::path path, std::span<const std::byte> bytes);
  /// Opens a file that another file names, by its path relative to `folder`. Throws `Error(Input)` that
  /// begins with `by`, the path of that other file, unless it lies in the folder or below it, also by way of
  /// symbolic links, and unless it is a regular file. Throws `Error(File)` if there is none.
  SourceFile(const std::filesystem::path& folder, const std::filesystem::path& name,
             const std::filesystem::path& by);
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
  /// Keeps an open descriptor, at whose place the file is read from now on.
  void keep(int descriptor);
  void copy();

  std::filesystem::path path_, place_;
  int descriptor_ = -1;  ///< Descriptor of the copy in memory, or of a file that another one names.
};

/// Returns the most bytes that a file may have to be read: half of the machine's memory, and no more than
/// what is left for this process.
uint64_t mostFileBytes();

/// Returns the open descriptor that a path such as /dev/stdin or /dev/fd/5 names, or -1.
int namedDescriptor(const std::filesystem::path& path);

}  // namespace raymap
