#include "base/progress.h"

#include <raymap/error.h>

#include <chrono>

namespace raymap {

double Progress::now() {
  using namespace std::chrono;
  return duration<double, std::milli>(steady_clock::now().time_since_epoch()).count();
}

void Progress::report(double done) {
  const double share = begin_ + length_ * done;
  for (double before = done_; before < share && !done_.compare_exchange_weak(before, share);) {
  }
  poll();
}

void Progress::poll() {
  if (!callback_) return;
  if (const std::unique_lock lock(mutex_, std::try_to_lock); lock && !cancelled_ && !callback_(name_, done_))
    cancelled_ = true;
  if (cancelled_) throw Error(ErrorCode::Cancelled, std::string("cancelled during ") + name_);
}

}  // namespace raymap
