#pragma once

#include <raymap/callbacks.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace raymap {

/// Times the stages of a run, reports its progress, and stops it if the callback returns false.
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
    done_ = 0.0;
    part(0.0, 1.0);
    report(0.0);
    work();
    times_.push_back({name, now() - start});
  }

  /// Reports the share of the stage that is done, 0 to 1. A stage calls it from any thread, every few
  /// milliseconds. The callback sees no smaller share than before, and is skipped while another thread runs
  /// it. Throws `Error(Cancelled)` once the callback has returned false, which is its last call.
  void report(double done);
  /// Maps all shares reported from now on to the part [begin, end] of the stage.
  void part(double begin, double end) {
    begin_ = begin;
    length_ = end - begin;
  }
  /// Reports the last share again, for work whose progress is unknown. Throws like `report`.
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

/// Counts work that several threads do, and reports it as the part [begin, end] of the stage.
class WorkMeter {
 public:
  WorkMeter(Progress& progress, double begin, double end, double total)
      : progress_(progress), begin_(begin), length_(end - begin), total_(total) {}

  /// Reports that `work` more is done. Throws like `Progress::report`.
  void add(uint64_t work) { progress_.report(begin_ + length_ * double(done_ += work) / total_); }

 private:
  Progress& progress_;
  double begin_, length_, total_;
  std::atomic<uint64_t> done_{0};
};

}  // namespace raymap
