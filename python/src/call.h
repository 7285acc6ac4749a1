#pragma once

#include <raymap/machine.h>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "bindings.h"

namespace raymap::python {

/// Runs a long call of the library without the GIL, and stops it on Ctrl-C.
///
/// The work runs in a thread of its own. The calling thread wakes up ten times a second, takes the GIL, lets
/// Python handle signals, and reports progress. Only so does Ctrl-C work: Python handles signals in its main
/// thread alone, and the library may call `ProgressCallback` from any.
class Call {
 public:
  /// `progress` is None or a callable that takes a stage and a share. It cancels by returning False or by
  /// raising.
  explicit Call(nb::object progress) : report_(std::move(progress)) {}

  /// Callbacks to give to the library. They stay valid as long as this object.
  ProgressCallback progress();
  WarningCallback warn();
  /// Returns the options with both.
  MachineOptions on(MachineOptions machine);

  /// Does the work. Throws what the work, the callable or a signal's handler throws. Then passes on warnings.
  /// Work at few points is short: without a callable, the calling thread does it, for a thread of its own
  /// would take longer.
  void run(const std::function<void()>& work, size_t points = SIZE_MAX);

 private:
  struct Report {
    std::string stage;
    double done = 0.0;
  };

  void deliver();
  void passOnWarnings();
  bool finishesSoon();

  nb::object report_;
  std::mutex mutex_;
  std::condition_variable end_;
  std::vector<Report> reports_;  ///< The latest of each stage that Python has not heard of.
  std::vector<Warning> warnings_;
  std::exception_ptr failure_;
  bool isOver_ = false;
  std::atomic<bool> isCancelled_{false};
};

}  // namespace raymap::python
