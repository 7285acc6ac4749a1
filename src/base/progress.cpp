#include "base/progress.h"

#include <raymap/error.h>

#include <chrono>

namespace raymap {

double Progress::now() {
  using namespace std::chrono;
  return duration<double, std::milli>(steady_clock::now().time_since_epoch()).count();
}

void Progress::report(double done) {
  done_ = begin_ + length_ * done;
  poll();
}

void Progress::poll() {
  if (!callback_) return;
  if (!cancelled_) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) return;  // Another thread is reporting: this step may be skipped.
    if (!callback_(name_, done_)) cancelled_ = true;
  }
  if (cancelled_) throw Error(ErrorCode::Cancelled, std::string("cancelled during ") + name_);
}

}  // namespace raymap
