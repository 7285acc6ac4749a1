#include "terminal.h"

#include <raymap/atomic_file.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <initializer_list>
#include <string>

namespace raymap {

namespace {

constexpr auto kQuietTime = std::chrono::seconds(1);
constexpr auto kRefreshTime = std::chrono::milliseconds(100);

std::atomic<int> caught{0};
std::atomic<bool> isCancellable{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

constexpr unsigned kPatience = 2;  // Seconds that the work has to stop after a cancellation.

extern "C" void onSignal(int signal) {
  if (signal == SIGALRM)
    signal = caught;
  else if (isCancellable && caught.exchange(signal) == 0) {
    alarm(kPatience);
    return;
  }
  removeTemporaries();
  _exit(128 + signal);
}

}  // namespace

void warn(std::string_view message) {
  std::fprintf(stderr, "raymap: warning: %s\n", std::string(message).c_str());
}

void catchSignals() {
  for (const int signal : {SIGINT, SIGTERM, SIGALRM}) std::signal(signal, onSignal);
}

int caughtSignal() {
  return caught;
}

ProgressLine::ProgressLine() : next_(Clock::now() + kQuietTime), isTerminal_(isatty(STDERR_FILENO) == 1) {
  isCancellable = true;
}

ProgressLine::~ProgressLine() {
  isCancellable = false;
  if (isShown_) std::fputs("\r\033[K", stderr);
}

bool ProgressLine::report(std::string_view stage, double done) {
  if (isTerminal_ && Clock::now() >= next_) {
    std::fprintf(stderr, "\r\033[K  %s %3.0f %%", std::string(stage).c_str(), 100.0 * done);
    next_ = Clock::now() + kRefreshTime;
    isShown_ = true;
  }
  return caught == 0;
}

}  // namespace raymap
