#include <fcntl.h>
#include <raymap/atomic_file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ostream>
#include <streambuf>
#include <string>
#include <system_error>
#include <vector>

#include "base/descriptor.h"
#include "base/source_file.h"
#include "base/temporary_file.h"

namespace raymap {

namespace fs = std::filesystem;

namespace {

/// Stream buffer over a file descriptor. Throws `Error(File)` with the system's reason if a write fails.
class DescriptorBuffer : public std::streambuf {
 public:
  DescriptorBuffer(int descriptor, const fs::path& path, bool isSeekable)
      : descriptor_(descriptor), path_(path), isSeekable_(isSeekable) {
    setp(buffer_.data(), buffer_.data() + buffer_.size());
  }

  void flush() {
    const char* begin = pbase();
    const auto count = static_cast<size_t>(pptr() - pbase());
    setp(buffer_.data(), buffer_.data() + buffer_.size());
    writeAll(descriptor_, path_, begin, count);
  }

 protected:
  int_type overflow(int_type c) override {
    flush();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }
  std::streamsize xsputn(const char* data, std::streamsize count) override {
    if (count > epptr() - pptr()) {
      flush();
      if (static_cast<size_t>(count) >= buffer_.size()) {
        writeAll(descriptor_, path_, data, static_cast<size_t>(count));
        return count;
      }
    }
    std::copy_n(data, count, pptr());  // Without data, there may be no address.
    pbump(static_cast<int>(count));
    return count;
  }
  int sync() override {
    flush();
    return 0;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction, std::ios_base::openmode) override {
    if (!isSeekable_) return {off_type(-1)};
    flush();
    const int whence = direction == std::ios_base::beg   ? SEEK_SET
                       : direction == std::ios_base::cur ? SEEK_CUR
                                                         : SEEK_END;
    return {lseek(descriptor_, offset, whence)};
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override {
    return seekoff(position, std::ios_base::beg, mode);
  }

 private:
  int descriptor_;
  const fs::path& path_;
  bool isSeekable_;
  std::vector<char> buffer_ = std::vector<char>(size_t{1} << 16);
};

void writeThrough(int descriptor, const fs::path& path, bool isSeekable,
                  const std::function<void(std::ostream&)>& write) {
  DescriptorBuffer buffer(descriptor, path, isSeekable);
  std::ostream stream(&buffer);
  stream.exceptions(std::ios_base::badbit);  // Lets the buffer's own exception through.
  write(stream);
  buffer.flush();
}

/// Writes to a device, a pipe or the target of /dev/stdout. They belong to other programs, so they are
/// neither replaced nor truncated. A descriptor such as /dev/stdout is used itself, and so is its position in
/// a file: what other programs wrote there before stays, and what they write next comes after it.
void writeInPlace(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  const int named = namedDescriptor(path);
  Descriptor file(
      named >= 0 ? fcntl(named, F_DUPFD_CLOEXEC, 0) : open(path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC),
      path);
  writeThrough(file.get(), path, false, write);
  file.finish(path);
}

bool isInPlace(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return namedDescriptor(path) >= 0 || path.string().starts_with("/proc/") ||
         (fs::exists(status) && !fs::is_regular_file(status));
}

/// Follows symbolic links and returns the file to write, which need not exist. Stops at names of descriptors.
fs::path resolveLinks(fs::path path) {
  constexpr int kMostLinks = 40;  // The kernel's own limit.
  std::error_code error;
  const auto isLink = [&] {
    return namedDescriptor(path) < 0 && fs::is_symlink(fs::symlink_status(path, error));
  };
  for (int i = 0; i < kMostLinks && isLink(); ++i) path = path.parent_path() / fs::read_symlink(path, error);
  return path;
}

void replace(const fs::path& target, const fs::path& path, const std::function<void(std::ostream&)>& write) {
  struct stat existing {};
  const bool replaces = stat(target.c_str(), &existing) == 0;
  if (replaces && access(target.c_str(), W_OK) != 0) throwWriteError(path, errno);

  TemporaryFile file(target, path);
  writeThrough(file.descriptor(), path, true, write);
  if (replaces && fchmod(file.descriptor(), existing.st_mode & kPermissions) != 0)
    throwWriteError(path, errno);
  if (fsync(file.descriptor()) != 0) throwWriteError(path, errno);
  file.publish();
}

}  // namespace

void writeAtomically(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  std::error_code error;
  if (fs::is_directory(path, error)) throwWriteError(path, EISDIR);
  if (const fs::path target = resolveLinks(path); isInPlace(target))
    writeInPlace(target, write);
  else
    replace(target, path, write);
}

void removeTemporaries() noexcept {
  TemporaryFile::removeAll();
}

}  // namespace raymap
