#include "base/memory.h"

#include <raymap/error.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>

namespace raymap {

namespace {

/// Returns the memory limit of the control group in bytes, or SIZE_MAX if there is none.
size_t groupLimit() {
  std::ifstream file("/sys/fs/cgroup/memory.max");
  size_t bytes = 0;
  return file >> bytes ? bytes : SIZE_MAX;
}

size_t systemAvailable() {
  std::ifstream file("/proc/meminfo");
  for (std::string key; file >> key; file.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
    size_t kibibytes = 0;
    if (key == "MemAvailable:" && file >> kibibytes) return kibibytes * 1024;
  }
  return SIZE_MAX;
}

std::string sizeText(uint64_t bytes, bool isRoundedUp) {
  constexpr uint64_t kKibibyte = uint64_t{1} << 10, kMebibyte = uint64_t{1} << 20;
  if (bytes < kKibibyte) return std::to_string(bytes) + (bytes == 1 ? " byte" : " bytes");
  const uint64_t unit = bytes < kMebibyte ? kKibibyte : kMebibyte;
  const uint64_t units = bytes / unit + (isRoundedUp && bytes % unit > 0 ? 1 : 0);
  return std::to_string(units) + (unit == kKibibyte ? " KiB" : " MiB");
}

}  // namespace

size_t availableMemory() {
  return std::min(systemAvailable(), groupLimit());
}

std::string neededText(uint64_t bytes) {
  return sizeText(bytes, true);
}

std::string limitText(uint64_t bytes) {
  return sizeText(bytes, false);
}

void checkFieldMemory(uint64_t needed, uint64_t limit, const std::string& why) {
  if (needed > limit)
    throw Error(ErrorCode::Memory, "the field needs " + neededText(needed) + why + ", but only " +
                                       limitText(limit) +
                                       " may be used; use a lower resolution or a higher limit");
}

void checkSurfaceMemory(uint64_t needed) {
  if (const uint64_t left = availableMemory(); needed > left)
    throw Error(ErrorCode::Memory, "the surface needs " + neededText(needed) + ", but only " +
                                       limitText(left) + " are left; use a lower resolution");
}

}  // namespace raymap
