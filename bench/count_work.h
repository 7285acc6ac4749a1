#pragma once

#include <string>
#include <vector>

namespace raymap::bench {

/// Rates and latencies of a card. The defaults are those of an NVIDIA H200.
struct Card {
  double bytesPerSecond = 4.3e12;
  double stepMicroseconds = 3.0;  ///< From one command to the next that waits for it.
  double warpInstructionsPerSecond = 0.92e12;
  double instructionNanoseconds = 2.0;  ///< From an instruction to the next that needs its result.
  double loadNanoseconds = 150.0;       ///< From a load to its value.
  double waitMicroseconds = 60.0;       ///< From the end of a submission to the start of the next.
};

struct CountOptions {
  std::string device = "vulkan";
  Card card;
  std::vector<std::string> meshes = {"bunny", "million"};
  std::vector<std::string> settings = {"default", "quick"};
  std::vector<int> resolutions = {50, 128, 256, 512};
  bool timesOnly = false;  ///< Measures the times of all kernels, and counts nothing.
};

/// Counts the work of fields stage by stage, and prints tables with the times that follow from it. Beside
/// them stand the times of runs without counters, unless the device computes in software.
void countWork(const CountOptions& options);

}  // namespace raymap::bench
