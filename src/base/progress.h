#pragma once

#include <raymap/callbacks.h>

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

namespace raymap {

/// Times the stages of a run, reports how far it is, and stops it when the caller says so.
class Progress {
 public:
  struct Time {
    std::string stage;
    double milliseconds = 0.0;
  };

  /// `callback` may be empty.
  explicit Progress(ProgressCallback callback = {}) : callback_(std::move(callback)) {}

  /// Runs one stage and records its time under `name`.
  template <class Work>
  void stage(const char* name, Work&& work) {
    const double start = now();
    name_ = name;
    part(0.0, 1.0);
    report(0.0);
    work();
    times_.push_back({name, now() - start});
  }

  /// Called by a stage, from any thread, every few milliseconds, with the share that is done. Throws
  /// `Error(Cancelled)`.
  void report(double done);
  /// Maps all shares reported from now on to this part of the stage.
  void part(double begin, double end) {
    begin_ = begin;
    length_ = end - begin;
  }
  /// Repeats the last share, for a stage that cannot say how far it is.
  void poll();

  const std::vector<Time>& times() const { return times_; }

 private:
  static double now();  // milliseconds

  ProgressCallback callback_;
  std::vector<Time> times_;
  const char* name_ = "";
  std::mutex mutex_;
  double begin_ = 0.0, length_ = 1.0;
  std::atomic<double> done_{0.0};
  std::atomic<bool> cancelled_{false};
};

}  // namespace raymap
