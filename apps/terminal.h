#pragma once

#include <raymap/callbacks.h>

#include <chrono>
#include <string_view>

namespace raymap {

/// Prints `raymap: warning: ...` on stderr.
void warn(std::string_view message);

/// Makes SIGINT and SIGTERM end the program at once, without a half-written file. While a `ProgressLine`
/// lives, the first signal cancels the work through its callback instead. It ends the program only if the
/// work does not stop within two seconds.
void catchSignals();

/// Returns the signal that cancelled the work, or 0.
int caughtSignal();

/// A line on stderr that shows the progress: only on a terminal, and only after a second.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Returns a callback that cancels the work after a signal. Valid while the line lives.
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
