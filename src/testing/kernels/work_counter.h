#pragma once

#include <memory>
#include <string>
#include <vector>

#include "testing/kernels/spirv_counters.h"
#include "vulkan/device/device.h"

namespace raymap::vulkan {

/// A command that the product recorded, and the work of the device for it.
struct CountedCommand {
  std::string name;   ///< Kernel, or "fill", "copy", "update".
  std::string stage;  ///< Stage that `setStage` named.
  uint32_t step = 0;  ///< Commands of a step may run at the same time; each step waits for the one before.
  uint32_t submission = 0;
  uint64_t groups = 0;  ///< Work groups; for an indirect dispatch, those that the device decided.
  uint32_t groupSize = 0;
  uint64_t touchableBytes = 0;  ///< Sum of the sizes of the buffers that its push constants point into.
  bool isMore = false;          ///< Whether it is a further part of the dispatch before.
  WorkCounters work{};
};

/// Counts what a device does: every command, barrier and submission that the product records, and the work of
/// every dispatch. The product runs as it is. Its kernels are changed to count their own work, which makes
/// them slower. Construct one before the `Device`, make all kernels while it lives; one at a time.
class WorkCounter {
 public:
  WorkCounter();
  ~WorkCounter();
  WorkCounter(const WorkCounter&) = delete;
  WorkCounter& operator=(const WorkCounter&) = delete;

  /// Reserves memory for the counters. Kernels must be made afterwards.
  void start(Device& device);
  /// Releases the memory; call it before the device is destroyed.
  void stop();

  /// Names the stage of the commands recorded from now on.
  void setStage(const std::string& stage);
  /// Forgets the commands so far.
  void clear();
  /// Returns the commands of all submissions that have completed.
  const std::vector<CountedCommand>& commands() const;

  struct State;

 private:
  struct Entries;
  std::unique_ptr<State> state_;
  std::unique_ptr<Entries> entries_;
};

}  // namespace raymap::vulkan
