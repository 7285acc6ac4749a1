#include "vulkan/device/kernel.h"

#include <stdexcept>

#include "vulkan/device/spirv.h"

namespace raymap::vulkan {

namespace {

PipelineSource sourceOf(const Device& device, const Shader& shader, uint32_t groupSize,
                        std::initializer_list<uint32_t> constants) {
  PipelineSource source{.shader = shader,
                        .constants = {groupSize},
                        .hasFullSubgroups = groupSize % device.limits().maxSubgroupSize == 0};
  source.constants.insert(source.constants.end(), constants);
  return source;
}

}  // namespace

ComputePipeline::ComputePipeline(Device& device, const Shader& shader, uint32_t pushBytes, uint32_t groupSize,
                                 std::initializer_list<uint32_t> constants)
    : device_(&device),
      groupSize_(groupSize),
      number_(device.pipelines().add(sourceOf(device, shader, groupSize, constants))) {
  const uint32_t declared = pushConstantBytes(shader.code);
  if (declared != pushBytes)
    throw std::logic_error("shader " + std::string(shader.name) + " declares " + std::to_string(declared) +
                           " bytes of push constants, C++ has " + std::to_string(pushBytes));
}

}  // namespace raymap::vulkan
