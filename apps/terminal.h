#pragma once

#include <raymap/callbacks.h>

#include <chrono>
#include <string_view>

namespace raymap {

/// `raymap: warning: ...` on stderr.
void warn(std::string_view message);

/// From now on SIGINT and SIGTERM end the program at once, without a half-written file; while a
/// `ProgressLine` lives, the first of them cancels the work through its callback instead, and ends the
/// program only if that takes longer than two seconds.
void catchSignals();

/// The signal that cancelled the work, or 0.
int caughtSignal();

/// A line on stderr that says how far the work is: only on a terminal, and only after a second.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Cancels once a signal was caught. Good for as long as the line lives.
  ProgressCallback callback() {
    return [this](std::string_view stage, double done) { return report(stage, done); };
  }

 private:
  bool report(std::string_view stage, double done);

  using Clock = std::chrono::steady_clock;
  Clock::time_point next_;
  bool isTerminal_;
  bool isShown_ = false;
};

}  // namespace raymap
