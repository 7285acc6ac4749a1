#include "base/temporary_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

namespace raymap {

namespace fs = std::filesystem;

namespace {

/// Hidden names in use. The table is fixed because a signal handler may neither lock nor allocate.
std::array<std::atomic<const char*>, 64> hiddenNames{};

/// Returns a hidden name in the target's folder. Each user has names of its own, and can remove such files.
std::string hiddenName(const fs::path& target, unsigned number) {
  constexpr size_t kLongest = 180;  // Bytes; leaves space for the rest within the usual limit of 255.
  const std::string name = target.filename().string().substr(0, kLongest);
  const std::string unique = std::to_string(geteuid()) + "-" + std::to_string(number);
  return (target.parent_path() / ("." + name + ".tmp" + unique)).string();
}

/// Locks a file as long as it is open. Returns false if another process has locked it. Without locks on the
/// file system it returns `otherwise`.
bool lock(int file, bool otherwise) {
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return true;
  return errno != EWOULDBLOCK && otherwise;
}

/// Removes a hidden file that no process writes.
void removeStale(const std::string& name) {
  const int file = open(name.c_str(), O_WRONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return;
  struct stat about {};
  const bool isOurs = fstat(file, &about) == 0 && S_ISREG(about.st_mode) && about.st_uid == geteuid();
  // Its name can change hands until it is locked.
  if (isOurs && lock(file, false) && hasName(file, name)) unlink(name.c_str());
  close(file);
}

/// Removes what killed processes left that wrote the target. More than a few never write it at once.
void removeAllStale(const fs::path& target) {
  constexpr unsigned kFew = 16;
  for (unsigned number = 0; number < kFew; ++number) removeStale(hiddenName(target, number));
}

/// Makes and locks a file. Returns -1 with EEXIST if the name is taken.
int makeHidden(const std::string& name) {
  const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  // Until it is locked, another process takes it for one that a killed process left.
  if (file < 0 || (lock(file, true) && hasName(file, name))) return file;
  close(file);
  errno = EEXIST;
  return -1;
}

std::string descriptorPath(int file) {
  return "/proc/self/fd/" + std::to_string(file);
}

/// Makes and locks a file without a name. Returns -1 if there is no such thing here.
int makeNameless(const fs::path& folder) {
  const int file = open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (file < 0) return -1;
  if (lock(file, true) && access(descriptorPath(file).c_str(), F_OK) == 0) return file;
  close(file);
  return -1;
}

/// Gives a name to a file without one. Returns false with EEXIST if the name is taken.
bool giveName(int file, const char* name) {
  return linkat(AT_FDCWD, descriptorPath(file).c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0;
}

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& target, const fs::path& path, Name wanted)
    : target_(target), path_(path), file_(make(wanted), path) {}

TemporaryFile::~TemporaryFile() {
  if (!name_.empty()) unlink(name_.c_str());
  forgetName();
}

int TemporaryFile::make(Name wanted) {
  removeAllStale(target_);
  int file = wanted == Name::None ? makeNameless(target_.parent_path()) : -1;
  if (file < 0) takeHiddenName([&](const std::string& name) { return (file = makeHidden(name)) >= 0; });
  return file;
}

void TemporaryFile::publish() {
  const auto take = [&](const std::string& name) { return giveName(file_.get(), name.c_str()); };
  if (name_.empty()) {
    if (giveName(file_.get(), target_.c_str())) return;
    // A link replaces no file, but a new name does.
    if (errno != EEXIST || !takeHiddenName(take)) throwWriteError(path_, errno);
  }
  if (rename(name_.c_str(), target_.c_str()) != 0) throwWriteError(path_, errno);
  forgetName();
}

/// Calls `take` with hidden names until it takes one. Returns false if it fails by another error than EEXIST.
template <class Take>
bool TemporaryFile::takeHiddenName(Take&& take) {
  constexpr unsigned kMost = 1000;  // Processes that write the same target at once.
  for (unsigned number = 0; number < kMost; ++number) {
    std::string name = hiddenName(target_, number);
    removeStale(name);
    if (take(name)) {
      setName(std::move(name));
      return true;
    }
    if (errno != EEXIST) break;
  }
  return false;
}

void TemporaryFile::setName(std::string name) {
  name_ = std::move(name);
  for (auto& slot : hiddenNames) {
    const char* empty = nullptr;
    if (!slot.compare_exchange_strong(empty, name_.c_str())) continue;
    slot_ = &slot;
    return;
  }  // If the table is full, a signal leaves the file to the next one that writes the target.
}

void TemporaryFile::forgetName() {
  if (slot_) slot_->store(nullptr);
  slot_ = nullptr;
  name_.clear();
}

void TemporaryFile::removeAll() noexcept {
  for (const auto& slot : hiddenNames)
    if (const char* name = slot.load()) unlink(name);
}

}  // namespace raymap
