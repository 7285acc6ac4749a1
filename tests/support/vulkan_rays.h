#pragma once

#include "vulkan/self_test/sign_probe.h"
#include "vulkan_device.h"

namespace raymap::vulkan {

/// A test of a stage that reads the ray map: it uploads the CPU's.
class VulkanRaysTest : public VulkanTest {
 protected:
  class Rays : public UploadedRays {
   public:
    explicit Rays(const cpu::RayMap& map) : UploadedRays(Probe(device()), map) {}
  };
};

}  // namespace raymap::vulkan
