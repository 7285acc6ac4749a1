#pragma once

#include <optional>

#include "vulkan/device/kernel.h"
#include "vulkan/stages/cell_lattice.h"

namespace raymap::vulkan {

/// Kernel that works on lattices. There is a faster variant for the lattice of the samples' own cells, which
/// holds most meshes (`kIsOfSamples` in cell_lattice.glsl). Only variants that were chosen are made.
template <class Push>
class LatticeKernel {
 public:
  LatticeKernel(Device& device, const Shader& shader, uint32_t groupSize)
      : device_(&device), shader_(shader), groupSize_(groupSize) {}

  /// Chooses the variant, by whether all lattices are that of the samples. Must be called before the first
  /// use.
  void choose(bool isOfSamples) {
    kernel_ = Kernel<Push>(*device_, shader_, groupSize_, {uint32_t{isOfSamples}});
  }
  Kernel<Push>& operator*() { return *kernel_; }

 private:
  Device* device_;
  Shader shader_;
  uint32_t groupSize_;
  std::optional<Kernel<Push>> kernel_;
};

}  // namespace raymap::vulkan
