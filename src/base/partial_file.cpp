#include "base/partial_file.h"

#include <fcntl.h>
#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <ostream>
#include <string>

namespace raymap {

namespace fs = std::filesystem;

namespace {

constexpr const char* kNoteMagic = "raymap-part";

fs::path withSuffix(fs::path path, const char* suffix) {
  path += suffix;
  return path;
}

}  // namespace

PartialFile::PartialFile(const fs::path& path, uint64_t key)
    : path_(path),
      target_(fs::weakly_canonical(path)),
      part_(withSuffix(target_, ".part")),
      note_(withSuffix(part_, ".done")),
      key_(key),
      file_(open(part_.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666), part_) {
  const bool isLocked = flock(file_.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
  // The name of a file can change until it is locked.
  if (!isLocked || !hasName(file_.get(), part_))
    throw Error(ErrorCode::File, part_.string() + ": another run is writing it");
  findLeft();
  if (ftruncate(file_.get(), off_t(end_)) != 0) throwWriteError(part_, errno);
  writeNote();
}

PartialFile::~PartialFile() {
  if (isPublished_ || noted_ > 0) return;
  unlink(part_.c_str());
  unlink(note_.c_str());
}

void PartialFile::findLeft() {
  struct stat about {};
  if (fstat(file_.get(), &about) != 0) throwWriteError(part_, errno);
  const auto size = uint64_t(about.st_size);
  std::ifstream note(note_);
  std::string magic;
  uint64_t key = 0, steps = 0, bytes = 0;
  const bool isOurs = bool(note >> magic >> key >> steps >> bytes) && magic == kNoteMagic;
  if (!isOurs && size > 0)
    throw Error(ErrorCode::File,
                part_.string() + ": it is in the way and was not left by an earlier run; move it");
  if (!isOurs || steps == 0) return;
  left_ = key != key_ ? Left::OtherWork : size < bytes ? Left::TooLittle : Left::Start;
  if (left_ != Left::Start) return;
  noted_ = steps;
  end_ = bytes;
}

void PartialFile::write(uint64_t place, std::span<const std::byte> bytes) {
  if (lseek(file_.get(), off_t(place), SEEK_SET) < 0) throwWriteError(part_, errno);
  writeAll(file_.get(), part_, reinterpret_cast<const char*>(bytes.data()), bytes.size());
  end_ = std::max(end_, place + bytes.size());
}

void PartialFile::note(uint64_t steps) {
  if (fsync(file_.get()) != 0) throwWriteError(part_, errno);
  noted_ = steps;
  writeNote();
}

void PartialFile::writeNote() {
  const std::string text = std::string(kNoteMagic) + ' ' + std::to_string(key_) + ' ' +
                           std::to_string(noted_) + ' ' + std::to_string(end_) + '\n';
  writeAtomically(note_, [&](std::ostream& out) { out << text; });
}

void PartialFile::publish() {
  struct stat existing {};
  const bool replaces = stat(target_.c_str(), &existing) == 0;
  if (replaces && access(target_.c_str(), W_OK) != 0) throwWriteError(path_, errno);
  if (replaces && fchmod(file_.get(), existing.st_mode & kPermissions) != 0) throwWriteError(path_, errno);
  if (fsync(file_.get()) != 0) throwWriteError(part_, errno);
  if (rename(part_.c_str(), target_.c_str()) != 0) throwWriteError(path_, errno);
  isPublished_ = true;
  unlink(note_.c_str());
}

}  // namespace raymap
