#include "memory.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>

namespace raymap {

namespace {

/// The memory limit of the control group, if there is one.
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

}  // namespace

size_t availableMemory() {
  return std::min(systemAvailable(), groupLimit());
}

}  // namespace raymap
