#include "call.h"

#include <raymap/error.h>

#include <chrono>
#include <string_view>
#include <thread>

#include "records.h"

namespace raymap::python {

namespace {

constexpr auto kPause = std::chrono::milliseconds(100);

/// Most points whose queries take a few milliseconds.
constexpr size_t kFewPoints = 1000;

}  // namespace

ProgressCallback Call::progress() {
  return [this](std::string_view stage, double done) {
    const std::lock_guard lock(mutex_);
    if (reports_.empty() || reports_.back().stage != stage) reports_.push_back({std::string(stage), done});
    reports_.back().done = done;
    return !isCancelled_;
  };
}

MachineOptions Call::on(MachineOptions machine) {
  machine.progress = progress();
  machine.warn = warn();
  return machine;
}

WarningCallback Call::warn() {
  return [this](const Warning& warning) {
    const std::lock_guard lock(mutex_);
    warnings_.push_back(warning);
  };
}

void Call::run(const std::function<void()>& work, size_t points) {
  if (points <= kFewPoints && report_.is_none()) {
    {
      const nb::gil_scoped_release release;
      work();
    }
    return passOnWarnings();
  }
  std::thread worker([&] {
    try {
      work();
    } catch (...) {
      failure_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    isOver_ = true;
    end_.notify_one();
  });
  try {
    while (!finishesSoon()) deliver();
  } catch (...) {
    isCancelled_ = true;
    const nb::gil_scoped_release release;
    worker.join();
    throw;
  }
  worker.join();
  if (failure_) std::rethrow_exception(failure_);
  deliver();
  passOnWarnings();
}

/// Waits a while, without the GIL. Returns whether the work is over.
bool Call::finishesSoon() {
  const nb::gil_scoped_release release;
  std::unique_lock lock(mutex_);
  return end_.wait_for(lock, kPause, [this] { return isOver_; });
}

void Call::deliver() {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
  std::vector<Report> reports;
  {
    const std::lock_guard lock(mutex_);
    reports.swap(reports_);
  }
  if (report_.is_none()) return;
  for (const Report& report : reports)
    if (report_(toText(report.stage), report.done).ptr() == Py_False)
      throw Error(ErrorCode::Cancelled, "cancelled during " + report.stage);
}

void Call::passOnWarnings() {
  if (warnings_.empty()) return;
  const nb::object warnUser = nb::module_::import_("raymap._errors").attr("warn");
  for (const Warning& each : warnings_)
    warnUser(toPython(each.code), toText(each.message), toPython(each.fields));
}

}  // namespace raymap::python
