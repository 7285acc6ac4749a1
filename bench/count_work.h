#pragma once

#include <string>
#include <vector>

namespace raymap::bench {

struct CountOptions {
  std::string device = "vulkan";
  std::vector<std::string> meshes = {"scan", "million"};
  std::vector<std::string> settings = {"default", "quick"};
  std::vector<int> resolutions = {50, 128, 256, 512};
  bool timesOnly = false;  ///< Measures the times of all kernels, and counts nothing.
};

/// Counts the work of fields stage by stage, and prints tables. Beside it stand the times of runs without
/// counters, unless the device computes in software.
void countWork(const CountOptions& options);

}  // namespace raymap::bench
