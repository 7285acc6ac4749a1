#pragma once

#include <memory>
#include <optional>
#include <string>

#include "vulkan/device/device_list.h"
#include "vulkan/device/features.h"
#include "vulkan/device/guards.h"
#include "vulkan/device/handle.h"
#include "vulkan/device/instance.h"

namespace raymap::vulkan {

struct DeviceOptions {
  std::optional<size_t>
      index;  ///< Which of `listDevices`; none = the best that is usable, software included.
  Validation validation = validationFromEnvironment();
  MessageCallback message;  ///< Gets what the validation layer says.
  bool guards = false;      ///< Guard bytes around every buffer, for tests: slow memory on a card.
};

struct DeviceLimits {
  uint32_t sharedMemory = 0;     ///< Bytes a work group may share,
  uint32_t groupSize = 0;        ///< and invocations in it.
  uint32_t minSubgroupSize = 0;  ///< Subgroups hold between these many invocations.
  uint32_t maxSubgroupSize = 0;
  uint64_t bufferSize = 0;     ///< Bytes of the largest buffer.
  double timestampPeriod = 0;  ///< Nanoseconds of one step of a timestamp; 0 = no timestamps.
  bool hasInt64Atomics = false;
  bool hasMemoryBudget = false;
};

/// What a buffer is for, and so which memory it gets.
enum class MemoryUse {
  Device,   ///< The device's own.
  Upload,   ///< The host writes, the device reads.
  ReadBack  ///< The device writes, the host reads.
};

/// An instance, a device and one queue, or those of the caller. One thread at a time.
class Device {
 public:
  /// Throws `Error(Unsupported)`: no loader, no driver, no such device, a feature missing.
  explicit Device(const DeviceOptions& options = {});
  /// A device of the caller's, made with at least the features of `requireFeatures`; it must outlive ours.
  /// Nobody else may use its queue while we submit to it.
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
  /// The layout of every kernel: no descriptors, `kPushBytes` bytes of push constants.
  VkPipelineLayout pipelineLayout() const { return pipelineLayout_.get(); }
  VkPipelineCache pipelineCache() const { return pipelineCache_.get(); }
  static constexpr uint32_t kPushBytes = 128;

  /// The memory type for a use among those in `allowed`.
  uint32_t memoryType(MemoryUse use, uint32_t allowed) const;
  /// Whether the host, too, reads and writes a memory type fast.
  bool isShared(uint32_t memoryType) const;
  /// Bytes that can still be had of a memory type without swapping.
  uint64_t availableMemory(uint32_t memoryType) const;
  /// Bytes held by our buffers, and what changes them.
  uint64_t heldMemory() const { return heldMemory_; }
  void changeHeldMemory(int64_t bytes) { heldMemory_ += static_cast<uint64_t>(bytes); }
  /// Null unless asked for.
  Guards* guards() const { return guards_.get(); }

  /// Gives an object a name for the validation layer's messages and for debuggers.
  template <class T>
  void setName(VkObjectType type, T handle, const std::string& name) const {
    setName(type, reinterpret_cast<uint64_t>(handle), name);
  }
  void setName(VkObjectType type, uint64_t handle, const std::string& name) const;

 private:
  /// Destroys it only if it is ours.
  struct Destroy {
    void operator()(VkDevice device) const {
      if (isOwned) vkDestroyDevice(device, nullptr);
    }
    bool isOwned;
  };

  void makeDevice();
  void readLimits();
  void makeShared();

  std::unique_ptr<Instance> ownInstance_;  // With the validation layer; else the shared one serves.
  DeviceHandles handles_;
  std::unique_ptr<std::remove_pointer_t<VkDevice>, Destroy> device_{nullptr, Destroy{true}};
  bool isBorrowed_ = false;
  DeviceInfo info_;
  DeviceLimits limits_;
  VkPhysicalDeviceMemoryProperties memory_{};
  PFN_vkSetDebugUtilsObjectNameEXT setName_ = nullptr;
  PipelineLayout pipelineLayout_;
  PipelineCache pipelineCache_;
  uint64_t heldMemory_ = 0;
  std::unique_ptr<Guards> guards_;
};

}  // namespace raymap::vulkan
