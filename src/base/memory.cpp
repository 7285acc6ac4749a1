#include "base/memory.h"

#include <raymap/error.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "base/parallel.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace raymap {

namespace {

/// Memory that no check counts: small arrays, names, and the pages of code that is used later.
constexpr size_t kUnplanned = size_t{8} << 20;

std::atomic<size_t> processLimit{0};
std::atomic<rlim_t> allocationsBefore{0};  ///< RLIMIT_DATA before a strict bound; 0: there is none.

/// Returns the bytes that a file of the kernel gives behind a key, in kilobytes there.
std::optional<size_t> bytesOf(const char* path, std::string_view wanted) {
  std::ifstream file(path);
  for (std::string key; file >> key; file.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
    size_t kibibytes = 0;
    if (key == wanted && file >> kibibytes) return kibibytes * 1024;
  }
  return {};
}

size_t systemAvailable() {
  return bytesOf("/proc/meminfo", "MemAvailable:").value_or(SIZE_MAX);
}

/// Returns what this process holds of what `key` counts.
size_t heldBytes(std::string_view key) {
  return bytesOf("/proc/self/status", key).value_or(0);
}

/// Returns what a limit of this process leaves of what `key` counts.
size_t leftOf(__rlimit_resource_t resource, std::string_view key) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return SIZE_MAX;
  return limit.rlim_cur - std::min<size_t>(heldBytes(key), limit.rlim_cur);
}

/// Returns what `limitMemory` leaves.
size_t leftOfProcess() {
  const size_t limit = processLimit;
  if (limit == 0) return SIZE_MAX;
#ifdef __GLIBC__
  malloc_trim(0);  // What was freed is not held.
#endif
  return limit - std::min(limit, heldBytes("VmRSS:") + kUnplanned);
}

/// Names that a version of control groups has for the limit, for the memory held, and for the part of it that
/// the kernel frees first: pages of files.
struct GroupFiles {
  const char *folder, *limit, *held, *statistics, *files;
};
constexpr GroupFiles kFirstVersion{"memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "memory.stat",
                                   "total_inactive_file"};
constexpr GroupFiles kSecondVersion{"", "memory.max", "memory.current", "memory.stat", "inactive_file"};

/// Returns what is left in one group, or SIZE_MAX if it has no limit.
size_t leftIn(const std::filesystem::path& group, const GroupFiles& files) {
  size_t limit = 0, held = 0, ofFiles = 0;
  if (!(std::ifstream(group / files.limit) >> limit)) return SIZE_MAX;
  std::ifstream(group / files.held) >> held;
  std::ifstream statistics(group / files.statistics);
  for (std::string key; statistics >> key >> ofFiles && key != files.files;) ofFiles = 0;
  held -= std::min(held, ofFiles);
  return limit - std::min(limit, held);
}

std::string sizeText(uint64_t bytes, bool isRoundedUp) {
  constexpr uint64_t kKibibyte = uint64_t{1} << 10, kMebibyte = uint64_t{1} << 20;
  if (bytes < kKibibyte) return std::to_string(bytes) + (bytes == 1 ? " byte" : " bytes");
  const uint64_t unit = bytes < kMebibyte ? kKibibyte : kMebibyte;
  const uint64_t units = bytes / unit + (isRoundedUp && bytes % unit > 0 ? 1 : 0);
  return std::to_string(units) + (unit == kKibibyte ? " KiB" : " MiB");
}

}  // namespace

size_t memoryLeftInGroups(const std::filesystem::path& ofProcess, const std::filesystem::path& root) {
  std::ifstream file(ofProcess);
  size_t left = SIZE_MAX;
  for (std::string line; std::getline(file, line);) {
    const size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const bool isSecondVersion = controllers.empty();
    if (!isSecondVersion && controllers != "memory") continue;
    const GroupFiles files = isSecondVersion ? kSecondVersion : kFirstVersion;
    const std::filesystem::path top = root / files.folder;
    std::filesystem::path group = std::filesystem::path(line.substr(second + 1)).relative_path();
    // The limits of all groups around this one hold, too.
    for (;; group = group.parent_path()) {
      left = std::min(left, leftIn(top / group, files));
      if (group.empty()) break;
    }
  }
  return left;
}

size_t memoryLeft() {
  return std::min({systemAvailable(), memoryLeftInGroups("/proc/self/cgroup", "/sys/fs/cgroup"),
                   leftOf(RLIMIT_AS, "VmSize:"), leftOf(RLIMIT_DATA, "VmData:"), leftOfProcess()});
}

void limitMemory(size_t bytes, bool isStrict) {
  allowAllocations();
  if (const size_t needed = heldBytes("VmRSS:") + kUnplanned; isStrict && bytes > 0 && bytes < needed)
    throw Error(ErrorCode::Memory, "this process needs at least " + neededText(needed) + ", but only " +
                                       limitText(bytes) + " may be used; allow more memory");
  processLimit = bytes;
  if (bytes == 0 || !isStrict) return;
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 17);  // Large arrays go back to the system when they are freed.
#endif
  startThreads();  // Their stacks are data, most of which is never touched.
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  const size_t data = heldBytes("VmData:"), resident = heldBytes("VmRSS:");
  const rlim_t strict = data + bytes - std::min(bytes, resident);
  if (limit.rlim_cur <= strict) return;
  allocationsBefore = limit.rlim_cur;
  limit.rlim_cur = strict;
  setrlimit(RLIMIT_DATA, &limit);
}

void allowAllocations() {
  const rlim_t before = allocationsBefore.exchange(0);
  rlimit limit{};
  if (before == 0 || getrlimit(RLIMIT_DATA, &limit) != 0) return;
  limit.rlim_cur = before;
  setrlimit(RLIMIT_DATA, &limit);
}

size_t mostMemory(size_t limit, size_t held) {
  const size_t most = held + std::min(memoryLeft(), SIZE_MAX - held);
  return limit > 0 ? std::min(limit, most) : most;
}

uint64_t mostInflated(uint64_t fileBytes) {
  constexpr uint64_t kMostRatio = 500, kSlack = uint64_t{64} << 20;
  return fileBytes > (UINT64_MAX - kSlack) / kMostRatio ? UINT64_MAX : kSlack + kMostRatio * fileBytes;
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
  if (const uint64_t left = memoryLeft(); needed > left)
    throw Error(ErrorCode::Memory, "the surface needs " + neededText(needed) + ", but only " +
                                       limitText(left) + " are left; use a lower resolution");
}

void checkFormatMemory(uint64_t needed) {
  if (const uint64_t left = memoryLeft(); needed > left)
    throw Error(ErrorCode::Memory, "the file's tree of samples needs " + neededText(needed) + ", but only " +
                                       limitText(left) +
                                       " are left; write another format, such as .npy, or allow more memory");
}

}  // namespace raymap
