#include "first_use.h"

#include <fcntl.h>
#include <raymap/devices.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <optional>
#include <thread>

#include "terminal.h"
#include "warnings.h"

namespace raymap {

namespace {

constexpr auto kPatience = std::chrono::minutes(5);  // The test itself gives up sooner where a check hangs.

std::optional<pid_t> startTest(const std::string& id) {
  std::string words[] = {"raymap", "devices", "--test", id};
  char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  for (const int output : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
  pid_t child = -1;
  const int code = posix_spawn(&child, "/proc/self/exe", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  return code == 0 ? std::optional(child) : std::nullopt;
}

/// Returns whether the process ended with success. Kills it when its time is up.
bool succeeds(pid_t child) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > deadline) {
      kill(child, SIGKILL);  // A driver may keep it even so: nobody waits for it.
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

void testBeforeFirstUse(std::string& device) {
  const std::string id = device == "auto" ? deviceToTest() : "";
  if (id.empty()) return;
  const auto hasPassed = [&id] {
    const WaitingLine line("testing " + id + " before its first use");
    const std::optional<pid_t> child = startTest(id);
    return child && succeeds(*child);
  };
  if (hasPassed() || deviceToTest() != id) return;
  warn({WarningCode::DeviceRefused,
        "the CPU is used instead of the GPU: the test of " + id + " did not pass; test it again to see why",
        {.device = id}});
  device = "cpu";
}

}  // namespace raymap
