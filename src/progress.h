#pragma once

#include <raymap/generate.h>

#include <atomic>
#include <mutex>

namespace raymap {

/// Times the stages of a run, tells the caller how far it is, and stops it when the caller says so.
class Progress {
 public:
  Progress(const Options& options, Stats& stats) : options_(options), stats_(stats) {}

  /// Runs one stage and records its time under `name`.
  template <class Work>
  void stage(const char* name, Work&& work) {
    const double start = now();
    name_ = name;
    part(0.0, 1.0);
    report(0.0);
    work();
    stats_.stages.push_back({name, now() - start});
  }

  /// Called by a stage, from any thread, every few milliseconds, with the share that is done. Throws
  /// `Error(Cancelled)`.
  void report(double done);
  /// From now on a stage reports shares of this part of it.
  void part(double begin, double end) {
    begin_ = begin;
    length_ = end - begin;
  }
  /// The same where a stage cannot tell how far it is: repeats the last share.
  void poll();

 private:
  static double now();  // milliseconds

  const Options& options_;
  Stats& stats_;
  const char* name_ = "";
  std::mutex mutex_;
  double begin_ = 0.0, length_ = 1.0;
  std::atomic<double> done_{0.0};
  std::atomic<bool> cancelled_{false};
};

}  // namespace raymap
