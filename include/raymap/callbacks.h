#pragma once

#include <raymap/warning.h>

#include <functional>
#include <string_view>

namespace raymap {

/// Reports the progress of a long call: the name of its current stage, and the share of that stage that is
/// done, 0 to 1. Returns true to go on, false to cancel; the call then throws `Error(Cancelled)`. Any thread
/// may call it, one at a time.
using ProgressCallback = std::function<bool(std::string_view stage, double done)>;

/// Receives what is odd but does not stop the call.
using WarningCallback = std::function<void(const Warning& warning)>;

}  // namespace raymap
