#include "io/import/confine.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>

#include "files.h"

namespace raymap {
namespace {

/// A file, and a process that is confined to it.
class Confine : public ::testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(file_) << "content";
    std::ofstream(other_) << "other";
  }

  /// Returns the status of a process that is confined, and then does something.
  int statusOf(const Confinement& limits, const std::function<int(int file)>& action) const {
    const pid_t child = fork();
    if (child == 0) {
      const int file = open(file_.c_str(), O_RDONLY);
      confine(file, limits);
      _exit(action(file));
    }
    int status = 0;
    waitpid(child, &status, 0);
    return status;
  }
  /// Returns the exit code of such a process, with ample limits.
  int codeOf(bool canOpen, const std::function<int(int file)>& action) const {
    const int status =
        statusOf({.memoryBytes = uint64_t{1} << 30, .seconds = 10, .canOpen = canOpen}, action);
    EXPECT_TRUE(WIFEXITED(status)) << status;
    return WEXITSTATUS(status);
  }
  static bool hasLandlock() { return syscall(SYS_landlock_create_ruleset, nullptr, 0, 1) > 0; }

  TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "file", other_ = folder_.path() / "other";
};

int codeOfCall(long result) {
  return result < 0 ? errno : 0;
}

TEST_F(Confine, ReadsTheOpenFileAndComputes) {
  EXPECT_EQ(codeOf(false,
                   [](int file) {
                     char text[8]{};
                     if (lseek(file, 0, SEEK_END) != 7 || lseek(file, 0, SEEK_SET) != 0) return 1;
                     if (read(file, text, sizeof text) != 7 || std::string(text) != "content") return 2;
                     struct stat about {};
                     if (fstat(file, &about) != 0 || about.st_size != 7) return 3;
                     const std::string large(size_t{1} << 24, 'a');  // Memory that the kernel maps.
                     const rlimit time{20, RLIM_INFINITY};
                     return setrlimit(RLIMIT_CPU, &time) == 0 && large.back() == 'a' ? 0 : 4;
                   }),
            0);
}

TEST_F(Confine, OpensNothingElse) {
  const auto openedAs = [&](const std::filesystem::path& path, int flags) {
    return [&path, flags](int) { return codeOfCall(open(path.c_str(), flags, 0600)); };
  };
  const std::filesystem::path made = folder_.path() / "made";
  for (const auto& path : {file_, other_}) EXPECT_EQ(codeOf(false, openedAs(path, O_RDONLY)), ENOSYS);
  const std::filesystem::path again = "/proc/self/fd/3";
  for (const bool canOpen : {false, true})
    for (const int flags : {O_WRONLY, O_RDWR, O_RDONLY | O_TRUNC, O_RDONLY | O_CREAT})
      EXPECT_EQ(codeOf(canOpen, openedAs(flags == (O_RDONLY | O_CREAT) ? made : other_, flags)), ENOSYS);
  EXPECT_EQ(codeOf(true,
                   [](int file) {
                     const std::string path = "/proc/self/fd/" + std::to_string(file);
                     return codeOfCall(open(path.c_str(), O_RDONLY));
                   }),
            0);
  EXPECT_EQ(codeOf(true, openedAs(other_, O_RDONLY)), hasLandlock() ? EACCES : 0);
  EXPECT_FALSE(exists(made));
  EXPECT_EQ(readBytes(other_), "other");
}

TEST_F(Confine, AsksTheKernelForNothingElse) {
  const auto code = [&](const std::function<long()>& call) {
    return codeOf(true, [&](int) { return codeOfCall(call()); });
  };
  EXPECT_EQ(code([] { return fork(); }), ENOSYS);
  EXPECT_EQ(code([] { return execl("/bin/true", "true", nullptr); }), ENOSYS);
  EXPECT_EQ(code([] { return socket(AF_INET, SOCK_STREAM, 0); }), ENOSYS);
  EXPECT_EQ(code([] { return kill(getppid(), 0); }), ENOSYS);
  EXPECT_EQ(code([] { return syscall(SYS_tgkill, getppid(), getppid(), 0); }), ENOSYS);
  EXPECT_EQ(code([] { return syscall(SYS_prlimit64, getppid(), RLIMIT_CPU, nullptr, nullptr); }), ENOSYS);
  EXPECT_EQ(code([&] { return unlink(other_.c_str()); }), ENOSYS);
  EXPECT_EQ(code([&] { return chdir("/"); }), ENOSYS);
}

TEST_F(Confine, LimitsMemoryFilesAndTime) {
  EXPECT_EQ(codeOf(false,
                   [](int) {
                     const auto limit = [](auto resource) {
                       rlimit found{};
                       getrlimit(resource, &found);
                       return found;
                     };
                     if (limit(RLIMIT_NOFILE).rlim_max != 16 || limit(RLIMIT_NPROC).rlim_max != 0) return 1;
                     if (limit(RLIMIT_FSIZE).rlim_max != 0 || limit(RLIMIT_CORE).rlim_max != 0) return 2;
                     return limit(RLIMIT_CPU).rlim_cur == 10 ? 0 : 3;
                   }),
            0);
  const Confinement small{.memoryBytes = 1 << 24, .seconds = 10};
  const auto allocate = [](size_t bytes) {
    return [bytes](int) {
      void* const memory = std::malloc(bytes);
      return memory ? 0 : errno;
    };
  };
  EXPECT_EQ(statusOf(small, allocate(size_t{1} << 22)), 0);
  EXPECT_EQ(WEXITSTATUS(statusOf(small, allocate(size_t{1} << 25))), ENOMEM);
}

TEST_F(Confine, CanAbort) {
  const int status = statusOf({.memoryBytes = 1 << 24, .seconds = 10}, [](int) -> int {
    signal(SIGABRT, SIG_DFL);
    std::abort();
  });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT) << status;
}

}  // namespace
}  // namespace raymap
