#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <type_traits>

#include "vulkan/device/device.h"
#include "vulkan/device/shader.h"

namespace raymap::vulkan {

/// Invocations in a group of most kernels.
inline constexpr uint32_t kGroup = 128;

/// Compute pipeline of a shader, made when a kernel of the device is first used.
class ComputePipeline {
 public:
  /// `groupSize` is specialization constant 0; `constants` are those from 1 on. If the group size is a
  /// multiple of the largest subgroup, all subgroups are full; kernels that use subgroups need full ones. The
  /// shader must declare `pushBytes` bytes of push constants.
  ComputePipeline(Device& device, const Shader& shader, uint32_t pushBytes, uint32_t groupSize,
                  std::initializer_list<uint32_t> constants);

  VkPipeline handle() const { return device_->pipelines().at(number_); }
  uint32_t groupSize() const { return groupSize_; }

 private:
  Device* device_;
  uint32_t groupSize_;
  size_t number_;  // Among the device's pipelines.
};

/// Pipeline with the C++ type of its push constants, which C++ and the shader share (base/shader_types.h).
template <class Push>
class Kernel : public ComputePipeline {
  static_assert(std::is_trivially_copyable_v<Push> && sizeof(Push) <= Device::kPushBytes &&
                sizeof(Push) % 4 == 0);

 public:
  Kernel(Device& device, const Shader& shader, uint32_t groupSize,
         std::initializer_list<uint32_t> constants = {})
      : ComputePipeline(device, shader, sizeof(Push), groupSize, constants) {}
};

}  // namespace raymap::vulkan
