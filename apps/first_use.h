#pragma once

#include <string>

namespace raymap {

/// Tests the GPU that `device` "auto" would use before its first use, in a process of its own: a driver that
/// crashes or hangs costs this one nothing. The library reads the result from the user's cache folder. If
/// that is off and the test fails, makes `device` the CPU and says so.
void testBeforeFirstUse(std::string& device);

}  // namespace raymap
