#include "io/import/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <raymap/error.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <system_error>

namespace raymap {

namespace {

[[noreturn]] void failStart(const std::filesystem::path& program, int code) {
  throw Error(ErrorCode::File,
              "cannot start " + program.string() + ": " + std::generic_category().message(code));
}

/// Starts the program with posix_spawn. fork would copy the locks of other threads in whatever state they
/// are.
int spawn(const std::filesystem::path& program, const std::vector<std::string>& arguments, int output,
          pid_t& pid) {
  std::string name = program.string();
  std::vector<std::string> words = arguments;
  std::vector<char*> argv{name.data()};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  // Nothing of the environment but where the program's libraries lie.
  const char* const libraries = std::getenv("LD_LIBRARY_PATH");
  std::string variable = std::string("LD_LIBRARY_PATH=") + (libraries ? libraries : "");
  char* environment[] = {libraries ? variable.data() : nullptr, nullptr};

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  const int code = posix_spawn(&pid, name.c_str(), &actions, nullptr, argv.data(), environment);
  posix_spawn_file_actions_destroy(&actions);
  return code;
}

}  // namespace

ChildProcess::ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                           int seconds)
    : deadline_(std::chrono::steady_clock::now() + std::chrono::seconds(seconds)) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) failStart(program, errno);
  const int code = spawn(program, arguments, ends[1], pid_);
  close(ends[1]);
  output_ = ends[0];
  if (code == 0) return;
  close(output_);
  failStart(program, code);
}

ChildProcess::~ChildProcess() {
  close(output_);
  reap(true);
}

bool ChildProcess::waitForOutput() const {
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd output{output_, POLLIN, 0};
    const int ready = poll(&output, 1, static_cast<int>(std::min<int64_t>(left.count(), 1 << 30)));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
}

size_t ChildProcess::read(void* data, size_t bytes) {
  size_t got = 0;
  while (got < bytes && waitForOutput()) {
    const ssize_t part = ::read(output_, static_cast<char*>(data) + got, bytes - got);
    if (part < 0 && errno == EINTR) continue;
    if (part <= 0) break;
    got += static_cast<size_t>(part);
  }
  return got;
}

void ChildProcess::reap(bool kill) {
  if (pid_ < 0) return;
  if (kill) ::kill(pid_, SIGKILL);
  while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
}

std::string ChildProcess::failure() {
  char rest = 0;
  const bool ended = read(&rest, 1) == 0 && waitForOutput();
  reap(!ended);
  if (!ended) return "it took too long";
  if (WIFSIGNALED(status_)) {
    const int signal = WTERMSIG(status_);
    if (signal == SIGXCPU || signal == SIGKILL) return "it took too long";
    return std::string("the importer crashed on it (") + strsignal(signal) + ")";
  }
  return WEXITSTATUS(status_) == 0 ? ""
                                   : "the importer ended with code " + std::to_string(WEXITSTATUS(status_));
}

}  // namespace raymap
