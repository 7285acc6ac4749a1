#include "base/source_file.h"

#include <fcntl.h>
#include <raymap/error.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "base/memory.h"
#include "base/text.h"

namespace raymap {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void failRead(const fs::path& path, int error) {
  throw Error(ErrorCode::File, path.string() + ": cannot read it: " + std::generic_category().message(error));
}

/// Returns whether bytes come one after the other, and once only.
bool isStream(const fs::path& path) {
  std::error_code error;
  const fs::file_type type = fs::status(path, error).type();
  return type == fs::file_type::fifo || type == fs::file_type::socket ||
         (type == fs::file_type::character && namedDescriptor(path) >= 0);
}

/// A descriptor that is closed at the end.
struct Opened {
  explicit Opened(const fs::path& path) {
    const int named = namedDescriptor(path);  // A socket cannot be opened by its name in /dev.
    value = named >= 0 ? fcntl(named, F_DUPFD_CLOEXEC, 0) : ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (value < 0) failRead(path, errno);
  }
  ~Opened() { close(value); }
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;
  int value = -1;
};

/// Writes all bytes. Returns whether that worked.
bool writeAll(int descriptor, const char* data, size_t count) {
  while (count > 0) {
    const ssize_t written = write(descriptor, data, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    data += written;
    count -= static_cast<size_t>(written);
  }
  return true;
}

}  // namespace

uint64_t mostFileBytes() {
  const auto pages = static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES));
  return std::min<uint64_t>(pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) / 2, memoryLeft());
}

int namedDescriptor(const fs::path& path) {
  if (path == "/dev/stdin") return STDIN_FILENO;
  if (path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  const std::string text = path.string();
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!text.starts_with(folder)) continue;
    int descriptor = -1;
    const char* const end = text.data() + text.size();
    const auto [next, error] = std::from_chars(text.data() + folder.size(), end, descriptor);
    if (error == std::errc() && next == end && descriptor >= 0) return descriptor;
  }
  return -1;
}

SourceFile::SourceFile(fs::path path) : path_(std::move(path)), place_(path_) {
  if (!isStream(path_)) return;
  keep(memfd_create("raymap", MFD_CLOEXEC));
  try {
    copy();
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

SourceFile::SourceFile(fs::path path, std::span<const std::byte> bytes) : path_(std::move(path)) {
  keep(memfd_create("raymap", MFD_CLOEXEC));
  if (writeAll(descriptor_, reinterpret_cast<const char*>(bytes.data()), bytes.size())) return;
  const int error = errno;
  close(descriptor_);
  failRead(path_, error);
}

SourceFile::SourceFile(const fs::path& folder, const fs::path& name, const fs::path& by)
    : path_(folder / name) {
  const auto fail = [&](const char* why) {
    throw Error(ErrorCode::Input, by.string() + ": it refers to " + excerpt(name.string(), kLongestName) +
                                      ", " + why +
                                      "; only regular files in its own folder are read; copy it there");
  };
  if (name.is_absolute() || std::ranges::find(name, "..") != name.end()) fail("a file outside its folder");
  keep(
      ::open(path_.c_str(), O_PATH | O_CLOEXEC));  // Looks at it only: a pipe would wait, a device might act.
  try {
    std::error_code error;
    const fs::path real = fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor_), error);
    const fs::path inside = fs::canonical(folder.empty() ? "." : folder, error);
    if (error || std::ranges::mismatch(inside, real).in1 != inside.end()) fail("a link out of its folder");
    if (!fs::is_regular_file(place_, error)) fail("which is not a regular file");
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

void SourceFile::keep(int descriptor) {
  descriptor_ = descriptor;
  if (descriptor_ < 0) failRead(path_, errno);
  place_ = "/proc/" + std::to_string(getpid()) + "/fd/" + std::to_string(descriptor_);
}

SourceFile::~SourceFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

fs::path SourceFile::folder() const {
  return descriptor_ >= 0 ? fs::path() : path_.parent_path();
}

std::string SourceFile::head(size_t bytes) const {
  std::ifstream file(place_, std::ios::binary);
  std::string text(bytes, '\0');
  file.read(text.data(), static_cast<std::streamsize>(bytes));
  text.resize(static_cast<size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return text;
}

void SourceFile::copy() {
  const Opened stream(path_);
  std::vector<char> piece(size_t{1} << 20);
  const uint64_t most = mostFileBytes();
  for (uint64_t total = 0;;) {
    const ssize_t count = read(stream.value, piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) failRead(path_, errno);
    if (count == 0) return;
    total += static_cast<uint64_t>(count);
    if (total > most)
      throw Error(ErrorCode::Memory, path_.string() + ": more than " + limitText(most) +
                                         " come through it, which is all that a file may take here");
    if (!writeAll(descriptor_, piece.data(), static_cast<size_t>(count))) failRead(path_, errno);
  }
}

}  // namespace raymap
