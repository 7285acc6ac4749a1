#pragma once

// Time and memory that a process has used so far.

#include <sys/resource.h>

#include <chrono>
#include <fstream>
#include <string>

namespace raymap::bench {

/// Returns the peak since it was last cleared. getrusage includes the peak of the program that started this
/// one.
inline double peakMegabytesNow() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0.0; word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024.0;
  return 0.0;
}

struct Usage {
  double wall, cpu, peakMegabytes;

  /// Clears the peak, so that it does not include making the mesh.
  static Usage start() {
    std::ofstream("/proc/self/clear_refs") << 5;
    return now();
  }
  static Usage now() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now().time_since_epoch();
    return {wall.count(), seconds(usage.ru_utime) + seconds(usage.ru_stime), peakMegabytesNow()};
  }
};

}  // namespace raymap::bench
