#include "base/descriptor.h"

#include <raymap/error.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

namespace raymap {

void throwWriteError(const std::filesystem::path& path, int error) {
  std::string message = path.string() + ": cannot write: " + std::generic_category().message(error);
  if (error == ENOSPC || error == EDQUOT) message += "; free some space or choose another folder";
  if (error == EPIPE) message += "; the program that reads it has ended";
  if (error == ENOENT) message += "; create the folder first";
  throw Error(ErrorCode::File, message);
}

void writeAll(int file, const std::filesystem::path& path, const char* data, size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(file, data, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throwWriteError(path, written < 0 ? errno : ENOSPC);
    data += written;
    count -= static_cast<size_t>(written);
  }
}

bool hasName(int file, const std::filesystem::path& name) {
  struct stat opened {};
  struct stat named {};
  return fstat(file, &opened) == 0 && lstat(name.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

Descriptor::Descriptor(int value, const std::filesystem::path& path) : value_(value) {
  if (value_ < 0) throwWriteError(path, errno);
}

Descriptor::~Descriptor() {
  if (value_ >= 0) close(value_);
}

void Descriptor::finish(const std::filesystem::path& path) {
  if (close(std::exchange(value_, -1)) != 0 && errno != EINTR) throwWriteError(path, errno);
}

}  // namespace raymap
