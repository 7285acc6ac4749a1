#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "vulkan/device/device_list.h"
#include "vulkan/device/features.h"
#include "vulkan/device/guards.h"
#include "vulkan/device/handle.h"
#include "vulkan/device/instance.h"
#include "vulkan/device/pipelines.h"

namespace raymap::vulkan {

struct DeviceOptions {
  std::optional<size_t> index;  ///< Index in `listDevices`; none selects the best usable device.
  Validation validation = validationFromEnvironment();
  MessageCallback message;  ///< Receives the validation layer's messages.
  bool guards =
      false;  ///< Puts guard bytes around every buffer, for tests; a card then works in the host's memory.
};

struct DeviceLimits {
  uint32_t groupSize = 0;        ///< Most invocations per work group.
  uint32_t sharedMemory = 0;     ///< Bytes per work group.
  uint32_t minSubgroupSize = 0;  ///< Fewest invocations per subgroup.
  uint32_t maxSubgroupSize = 0;
  uint64_t bufferSize = 0;     ///< Size of the largest buffer that kernels can use, bytes.
  double timestampPeriod = 0;  ///< Nanoseconds per timestamp step; 0 = no timestamps.
  uint32_t timestampBits = 0;  ///< Bits of a timestamp that are valid, the lowest ones.
  bool hasMemoryBudget = false;
};

/// Use of a buffer, which decides its memory type.
enum class MemoryUse {
  Device,   ///< Memory of the device's own.
  Upload,   ///< The host writes, the device reads.
  ReadBack  ///< The device writes, the host reads.
};

/// Instance, device and one queue, our own or the caller's. Not thread-safe: one thread at a time.
class Device {
 public:
  /// Throws `Error(Unsupported)` if there is no loader, no driver or no such device, or if a feature is
  /// missing.
  explicit Device(const DeviceOptions& options = {});
  /// Borrows a caller's device, created with at least the features of `requireFeatures`. It must outlive this
  /// object. Nobody else may use its queue while we submit to it.
  explicit Device(const DeviceHandles& borrowed);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkDevice handle() const { return device_.get(); }
  const DeviceHandles& handles() const { return handles_; }
  VkQueue queue() const { return handles_.queue; }
  uint32_t queueFamily() const { return handles_.queueFamily; }
  const DeviceInfo& info() const { return info_; }
  const DeviceLimits& limits() const { return limits_; }
  /// Layout of every kernel: no descriptors, `kPushBytes` bytes of push constants.
  VkPipelineLayout pipelineLayout() const { return pipelineLayout_.get(); }
  Pipelines& pipelines() { return *pipelines_; }
  static constexpr uint32_t kPushBytes = 128;

  /// Returns the memory type for a use, among those in `allowed`. Throws `Error(Unsupported)` if none suits.
  uint32_t memoryType(MemoryUse use, uint32_t allowed) const;
  /// Returns whether the host can also read and write a memory type fast.
  bool isShared(uint32_t memoryType) const;
  /// Returns the bytes that a memory type can still provide without swapping.
  uint64_t availableMemory(uint32_t memoryType) const;
  /// Bytes held by our buffers.
  uint64_t heldMemory() const { return heldMemory_; }
  void changeHeldMemory(int64_t bytes) { heldMemory_ += static_cast<uint64_t>(bytes); }
  /// Limits the bytes that our buffers may hold: no buffer grows beyond it.
  void limitMemory(uint64_t bytes) { mostMemory_ = bytes; }
  /// Returns the bytes that the limit leaves.
  uint64_t memoryLeft() const { return mostMemory_ - std::min(mostMemory_, heldMemory_); }
  /// Guards of the buffers; null unless `DeviceOptions::guards` is set.
  Guards* guards() const { return guards_.get(); }

  /// Names an object for the validation layer's messages and for debuggers.
  template <class T>
  void setName(VkObjectType type, T handle, const std::string& name) const {
    setName(type, reinterpret_cast<uint64_t>(handle), name);
  }
  void setName(VkObjectType type, uint64_t handle, const std::string& name) const;

 private:
  /// Destroys the device only if it is ours.
  struct Destroy {
    void operator()(VkDevice device) const {
      if (isOwned) vkDestroyDevice(device, nullptr);
    }
    bool isOwned;
  };

  void makeDevice();
  void readLimits();
  void makeShared();

  std::unique_ptr<Instance> ownInstance_;  // With the validation layer; null if the shared instance serves.
  DeviceHandles handles_;
  std::unique_ptr<std::remove_pointer_t<VkDevice>, Destroy> device_{nullptr, Destroy{true}};
  bool isBorrowed_ = false;
  DeviceInfo info_;
  DeviceLimits limits_;
  VkPhysicalDeviceMemoryProperties memory_{};
  PFN_vkSetDebugUtilsObjectNameEXT setName_ = nullptr;
  PipelineLayout pipelineLayout_;
  std::optional<Pipelines> pipelines_;
  uint64_t heldMemory_ = 0, mostMemory_ = UINT64_MAX;
  std::unique_ptr<Guards> guards_;
};

}  // namespace raymap::vulkan
