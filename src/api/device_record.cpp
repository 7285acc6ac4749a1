#include "api/device_record.h"

#include <fcntl.h>
#include <raymap/error.h>
#include <raymap/version.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <mutex>
#include <ostream>
#include <sstream>
#include <thread>

#include "base/descriptor.h"
#include "base/hash.h"
#include "base/user_cache.h"
#include "method/gpu_plug_in.h"

namespace raymap {

namespace fs = std::filesystem;

namespace {

constexpr const char* kTitle = "raymap GPU test 1";  // The number is that of the file's format.

/// Returns what a record must agree in, on one line.
std::string keyOf(const DeviceInfo& device) {
  char kernels[20];
  std::snprintf(kernels, sizeof kernels, "%016llx",
                static_cast<unsigned long long>(gpuPlugIn()->kernelHash()));
  std::string key = std::string(version().text) + " " + kernels + " " + device.fingerprint + " " +
                    device.name + " " + device.driver;
  std::ranges::replace(key, '\n', ' ');
  return key;
}

/// Returns the name of a device's files, without extension.
std::string stemOf(const DeviceInfo& device) {
  char text[40];
  std::snprintf(text, sizeof text, "gpu-test-%016llx",
                static_cast<unsigned long long>(hashOf(keyOf(device))));
  return text;
}

/// Returns the path of the mark of a test.
std::optional<fs::path> pathOf(const DeviceInfo& device) {
  const std::optional<fs::path> folder = userCacheFolder();
  if (!folder) return std::nullopt;
  return *folder / (stemOf(device) + ".running");
}

/// Results that could not be written to the folder, by `keyOf`.
struct Memory {
  std::mutex mutex;
  std::map<std::string, DeviceRecord> records;
};
Memory& memory() {
  static Memory memory;
  return memory;
}

/// Returns a record's file, or none if it is missing, damaged or another device's.
std::optional<DeviceRecord> readFile(const DeviceInfo& device) {
  constexpr uint64_t kMostBytes = 1 << 16;
  const std::optional<std::string> content = readUserCache(stemOf(device) + ".txt", kMostBytes);
  if (!content) return std::nullopt;
  std::istringstream file(*content);
  std::string title, key, result, problem, end;
  std::getline(file, title);
  std::getline(file, key);
  std::getline(file, result);
  std::getline(file, problem);
  std::getline(file, end);
  if (title != kTitle || key != keyOf(device) || end != "end") return std::nullopt;
  if (result == "passed" && problem.empty()) return DeviceRecord{DeviceTestState::Passed};
  if (result == "failed" && !problem.empty()) return DeviceRecord{DeviceTestState::Failed, problem};
  return std::nullopt;
}

/// Returns the state that the mark of a test shows, if there is one.
std::optional<DeviceRecord> readMark(const DeviceInfo& device) {
  const std::optional<fs::path> path = pathOf(device);
  const int file = path ? open(path->c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC) : -1;
  if (file < 0) return std::nullopt;
  std::optional<DeviceRecord> record = DeviceRecord{DeviceTestState::Running};
  if (flock(file, LOCK_SH | LOCK_NB) == 0) {
    char check[200];
    const ssize_t bytes = pread(file, check, sizeof check, 0);
    // Without text it is being made. A test that has ended meanwhile has removed it.
    if (bytes > 0) record = {DeviceTestState::Unfinished, std::string(check, static_cast<size_t>(bytes))};
    if (!hasName(file, *path)) record.reset();
  }
  if (!isOwnFile(file)) record.reset();
  close(file);
  return record;
}

/// Locks a file at a path. Returns -1 if the file cannot be made, is not this user's own, or is locked.
int lockFile(const fs::path& path, bool& isLocked) {
  isLocked = false;
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  if (file < 0) return -1;
  // Its owner may have removed it meanwhile.
  if (isOwnFile(file) && flock(file, LOCK_EX | LOCK_NB) == 0 && hasName(file, path)) return file;
  isLocked = isOwnFile(file);
  close(file);
  return -1;
}

}  // namespace

DeviceRecord readResult(const DeviceInfo& device) {
  if (std::optional<DeviceRecord> kept = readFile(device)) return *kept;
  const std::lock_guard lock(memory().mutex);
  const auto found = memory().records.find(keyOf(device));
  return found == memory().records.end() ? DeviceRecord{} : found->second;
}

DeviceRecord readRecord(const DeviceInfo& device) {
  if (std::optional<DeviceRecord> mark = readMark(device)) return *mark;
  return readResult(device);
}

void writeRecord(const DeviceInfo& device, const DeviceRecord& record) {
  std::string problem = record.problem;
  std::ranges::replace(problem, '\n', ' ');
  const bool isKept = writeUserCache(stemOf(device) + ".txt", [&](std::ostream& file) {
    file << kTitle << "\n"
         << keyOf(device) << "\n"
         << (record.state == DeviceTestState::Passed ? "passed" : "failed") << "\n"
         << problem << "\nend\n";
  });
  const std::lock_guard lock(memory().mutex);
  if (isKept)
    memory().records.erase(keyOf(device));
  else
    memory().records[keyOf(device)] = record;
}

TestMark::TestMark(const DeviceInfo& device, double seconds) {
  const std::optional<fs::path> path = pathOf(device);
  if (!path) return;
  makeUserCache(path->parent_path());
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
  for (bool isLocked = true; isLocked;) {
    file_ = lockFile(*path, isLocked);
    if (isLocked && Clock::now() > deadline)
      throw Error(ErrorCode::Unsupported,
                  device.id + " (" + device.name + ") is being tested by another process; try again later");
    if (isLocked) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  path_ = *path;
  write("start");
}

TestMark::~TestMark() {
  if (file_ < 0) return;
  unlink(path_.c_str());
  close(file_);
}

void TestMark::write(const std::string& check) const {
  if (file_ < 0) return;
  // A mark that cannot be written still marks.
  if (ftruncate(file_, 0) == 0 && pwrite(file_, check.data(), check.size(), 0) < 0) errno = 0;
}

}  // namespace raymap
