#pragma once

#include <cstddef>
#include <filesystem>

namespace raymap {

/// The bits of a file's mode that a file in its place gets. Those that lend the owner's rights to whoever
/// runs it (setuid, setgid) are left out, for the new file may have another owner.
inline constexpr unsigned kPermissions = 0777;

/// Throws `Error(File)`: the path cannot be written, by an error of the system.
[[noreturn]] void throwWriteError(const std::filesystem::path& path, int error);

/// Writes all bytes to an open file. Throws `Error(File)` that names the path.
void writeAll(int file, const std::filesystem::path& path, const char* data, size_t count);

/// Returns whether a name still leads to an open file.
bool hasName(int file, const std::filesystem::path& name);

/// Descriptor of a file that is written. It closes the file.
class Descriptor {
 public:
  /// Takes what `open` or `fcntl` returned. Throws `Error(File)` if that failed.
  Descriptor(int value, const std::filesystem::path& path);
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int get() const { return value_; }
  /// Closes the file. Throws `Error(File)` for an error that the system reports only now, as network file
  /// systems do.
  void finish(const std::filesystem::path& path);

 private:
  int value_;
};

}  // namespace raymap
