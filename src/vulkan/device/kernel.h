#pragma once

#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

#include "vulkan/device/device.h"
#include "vulkan/device/shader.h"

namespace raymap::vulkan {

/// A shader made ready for a device when it is first used.
class ComputePipeline {
 public:
  /// `groupSize` is specialization constant 0, `constants` those from 1 on. Where a group is a multiple of
  /// the largest subgroup, its subgroups are full; kernels that use subgroups need that.
  /// The shader must declare `pushBytes` bytes of push constants.
  ComputePipeline(Device& device, const Shader& shader, uint32_t pushBytes, uint32_t groupSize,
                  std::initializer_list<uint32_t> constants);

  VkPipeline handle();
  uint32_t groupSize() const { return constants_.front(); }

 private:
  void make();

  Device* device_;
  Shader shader_;
  std::vector<uint32_t> constants_;
  Pipeline pipeline_;
};

/// A pipeline with the C++ type of its push constants, which the shader declares too (src/shared).
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
