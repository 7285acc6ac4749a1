#pragma once

#include <cstdint>
#include <string>

namespace raymap {

/// Kinds of devices, in the order in which the device name "vulkan" prefers them; the CPU stands apart.
enum class DeviceType { Discrete, Integrated, Virtual, Other, Software, Cpu };

/// Outcome of the last test of a GPU (`testDevice`) with this driver, this version of raymap and its kernels.
enum class DeviceTestState {
  Untested,
  Running,  ///< Another thread or process tests it now.
  Passed,
  Failed,
  Unfinished,  ///< The test ended the process, or was killed.
};

/// A device that can compute fields.
struct DeviceInfo {
  std::string id = {};    ///< Value for `MachineOptions::device`: "cpu", "vulkan:0", "vulkan:1", …
  std::string name = {};  ///< Name of the processor or GPU.
  DeviceType type = DeviceType::Other;  ///< Kind of the device.
  std::string driver = {};              ///< Name and version of the driver; empty for the CPU.
  unsigned threads = 0;                 ///< Number of hardware threads of the CPU; 0 for others.
  uint64_t memory = 0;                  ///< Bytes of its largest heap; for the CPU, bytes available now.
  uint32_t sharedMemory = 0;            ///< Bytes of shared memory per work group; 0 for the CPU.
  std::string problem = {};             ///< Reason why it cannot be used; empty if it can.
  std::string vulkanVersion = {};       ///< Version of Vulkan, such as "1.3.230"; empty for the CPU.
  uint32_t subgroupSize = 0;            ///< Usual number of invocations per subgroup; 0 for the CPU.
  uint32_t minSubgroupSize = 0;         ///< Fewest that a kernel may have.
  uint32_t maxSubgroupSize = 0;         ///< Most that a kernel may have.
  std::string fingerprint = {};  ///< Differs for every device and version of a driver; empty for the CPU.
  DeviceTestState test = DeviceTestState::Untested;  ///< Outcome of the last test of a GPU.
  std::string testProblem = {};  ///< First difference, or the check in which the test ended; empty if passed.
  bool chosenByAuto = false;     ///< Whether the device "auto" is this one. It tests a GPU first.
};

/// One check of a GPU: a stage, or whole fields.
struct DeviceCheck {
  std::string name = {};        ///< Name of the check.
  std::string difference = {};  ///< First difference from the right result; empty if there is none.
  double milliseconds = 0.0;    ///< Time of the check.
};

}  // namespace raymap
