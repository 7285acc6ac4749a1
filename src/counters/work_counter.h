#pragma once

#include <memory>
#include <string>
#include <vector>

#include "counters/spirv_accesses.h"
#include "counters/spirv_counters.h"
#include "vulkan/device/device.h"
#include "vulkan/device/shader.h"

namespace raymap::vulkan {

/// Memory that a command itself reads or writes, by its address.
struct TouchedRange {
  uint64_t address, bytes;
  Access::Kind kind;
};

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
  std::vector<TouchedRange> ranges{};  ///< Of a fill, update, copy, or of the numbers of groups.
  WorkCounters work{};
  double milliseconds = 0.0;  ///< From the end of the command before to its end; 0 unless times are measured.
};

/// Figures of a command besides those that the product records.
enum class Measured {
  Work,  ///< The work of every dispatch. Kernels are changed to count it themselves, which makes them slower.
  Time,  ///< The time of every command, by the device's clock. Kernels stay as they are.
  Races  ///< The accesses to memory that nothing orders (findRaces). Kernels are changed to log accesses.
};

/// Measures what a device does: every command, barrier and submission that the product records, and the work
/// or the time of each, or the races between them. The product runs as it is. Construct one before the
/// `Device`, make all kernels while it lives; one at a time.
class WorkCounter {
 public:
  explicit WorkCounter(Measured measured = Measured::Work);
  ~WorkCounter();
  WorkCounter(const WorkCounter&) = delete;
  WorkCounter& operator=(const WorkCounter&) = delete;

  /// Reserves memory for the counters, and queries for the times. Kernels must be made afterwards.
  void start(Device& device);
  /// Releases the memory; call it before the device is destroyed.
  void stop();

  /// Takes other code for a shader of the library, for modules that are made from now on.
  void replace(const Shader& shader);
  /// Names the stage of the commands recorded from now on.
  void setStage(const std::string& stage);
  /// Forgets the commands so far.
  void clear();
  /// Returns the commands of all submissions that have completed.
  const std::vector<CountedCommand>& commands() const;
  /// Describes the races in all submissions that have completed.
  std::vector<std::string> races() const;

  struct State;

 private:
  struct Entries;
  std::unique_ptr<State> state_;
  std::unique_ptr<Entries> entries_;
};

}  // namespace raymap::vulkan
