// Krayer & Müller 2019, §3: dynamic data, which never leave the device. GPU twin of mesh/animated_mesh.cpp.

#include "vulkan/stages/skin.h"

#include <stdexcept>

#include "shaders/skin_spv.h"

namespace raymap::vulkan {

SkinStage::SkinStage(Device& device) : kernel_(device, shaders::kSkin, kGroup) {
  kernel_.handle();  // Makes the kernel now, not while a frame is recorded.
}

void SkinStage::record(Commands& commands, const Input& input, VkDeviceAddress vertices) {
  if (input.weights % 16 != 0 || input.matrices % 16 != 0)
    throw std::logic_error("weights or matrices of a skin not at a multiple of 16 bytes");
  commands.dispatch(kernel_,
                    {.rest = input.rest,
                     .vertices = vertices,
                     .joints = input.joints,
                     .weights = input.weights,
                     .matrices = input.matrices,
                     .vertexCount = input.vertexCount,
                     .jointCount = input.jointCount},
                    input.vertexCount);
}

}  // namespace raymap::vulkan
