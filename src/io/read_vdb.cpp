// Reads .vdb in a child process with limits: OpenVDB trusts its files, so a damaged one may crash it or ask
// for any memory, and neither may reach the caller.

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>

#include "field_formats.h"
#include "vdb.h"

namespace raymap {

namespace {

constexpr std::array<char, 4> kVdbMagic{' ', 'B', 'D', 'V'};

class SharedMemory {
 public:
  SharedMemory() : descriptor_(memfd_create("raymap", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw Error(ErrorCode::Memory, "no memory to read a field");
  }
  ~SharedMemory() { close(descriptor_); }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;
  int descriptor() const { return descriptor_; }

  /// Reads from the start; the number of bytes read.
  size_t read(size_t offset, void* to, size_t count) const {
    size_t done = 0;
    while (done < count) {
      const ssize_t got =
          pread(descriptor_, static_cast<char*>(to) + done, count - done, static_cast<off_t>(offset + done));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) break;
      done += static_cast<size_t>(got);
    }
    return done;
  }

 private:
  int descriptor_;
};

/// What OpenVDB may hold: its densest files grow at most 64-fold in memory (masks of its inner nodes).
void limitResources([[maybe_unused]] uint64_t fileBytes) {
  constexpr rlim_t kSeconds = 300;
  const rlimit time{kSeconds, kSeconds};
  setrlimit(RLIMIT_CPU, &time);
  const rlimit noCore{0, 0};
  setrlimit(RLIMIT_CORE, &noCore);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  long pages = 0;
  if (FILE* statm = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(statm, "%ld", &pages) != 1) pages = 0;
    std::fclose(statm);
  }
  constexpr uint64_t kGrowth = 80, kSpare = uint64_t{64} << 20;
  const auto held = static_cast<uint64_t>(pages) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  const rlim_t bytes = held + kSpare + kGrowth * fileBytes;
  const rlimit memory{bytes, bytes};
  if (pages > 0) setrlimit(RLIMIT_AS, &memory);
#endif
}

/// The child's whole life: the samples go to one memory, what went wrong to the other.
[[noreturn]] void runChild(const std::filesystem::path& path, uint64_t fileBytes, uint64_t limit, int samples,
                           int problem) {
  const int silence = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (silence >= 0) dup2(silence, STDERR_FILENO);
  limitResources(fileBytes);
  int code = 0;
  const auto report = [&](ErrorCode error, std::string_view message) {
    code = static_cast<int>(error);
    if (write(problem, message.data(), message.size()) < 0) code = static_cast<int>(ErrorCode::Memory);
  };
  try {
    copyVdb(path, limit, samples);
  } catch (const Error& e) {
    report(e.code(), e.what());
  } catch (const std::bad_alloc&) {
    report(ErrorCode::Input, path.string() + ": it declares more than its bytes can hold");
  } catch (const std::exception& e) {
    report(ErrorCode::Input, path.string() + ": OpenVDB cannot read it: " + e.what());
  }
  _exit(code);
}

int waitFor(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return status;
}

/// Leaves the contents in `samples`, or throws what the child says.
void readInChild(const std::filesystem::path& path, uint64_t fileBytes, const SharedMemory& samples) {
  constexpr uint64_t kMostGrowth = 2000;  // A thin band in a large box, with room to spare.
  constexpr uint64_t kAlways = uint64_t{64} << 20;
  initializeVdb();
  const SharedMemory problem;
  const pid_t child = fork();
  if (child < 0) throw Error(ErrorCode::Memory, path.string() + ": no process to read it in");
  if (child == 0)
    runChild(path, fileBytes, kAlways + kMostGrowth * fileBytes, samples.descriptor(), problem.descriptor());
  const int status = waitFor(child);
  if (status == -1 || !WIFEXITED(status))
    throwInvalid(path, "it is damaged: OpenVDB crashed, or took too long, while reading it");
  if (WEXITSTATUS(status) == 0) return;
  std::string message(4096, '\0');
  message.resize(problem.read(0, message.data(), message.size()));
  throw Error(static_cast<ErrorCode>(WEXITSTATUS(status)), message);
}

}  // namespace

Field readVdb(const std::filesystem::path& path) {
  InputFile file(path);
  const uint64_t fileBytes = file.remaining();
  std::array<char, kVdbMagic.size()> magic{};
  file.read(magic.data(), magic.size());
  if (magic != kVdbMagic) throwInvalid(path, "does not begin as a VDB");

  const SharedMemory samples;
  readInChild(path, fileBytes, samples);
  VdbContents contents;
  size_t at = samples.read(0, &contents, sizeof contents);
  if (at != sizeof contents) throwInvalid(path, "OpenVDB gave no grid");
  Field field;
  setDims(field.grid, contents.dims);
  field.grid.origin = {contents.origin[0], contents.origin[1], contents.origin[2]};
  field.grid.spacing = contents.spacing;
  field.band = contents.band;
  checkPlacement(path, field);
  const bool isOurs =
      std::string_view(contents.name.data()) != "triangle" || contents.type == ElementType::Int32;
  readArray(path, field, isOurs ? contents.name.data() : "distance", {contents.type},
            [&](void* to, size_t count) {
              if (samples.read(at, to, count) != count) throwInvalid(path, "OpenVDB gave too few samples");
              at += count;
            });
  return field;
}

}  // namespace raymap
