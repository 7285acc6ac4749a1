#include "vulkan/device/kernel.h"

#include <stdexcept>

#include "vulkan/device/spirv.h"

namespace raymap::vulkan {

ComputePipeline::ComputePipeline(Device& device, const Shader& shader, uint32_t pushBytes, uint32_t groupSize,
                                 std::initializer_list<uint32_t> constants)
    : device_(&device), shader_(shader), constants_{groupSize} {
  constants_.insert(constants_.end(), constants);
  const uint32_t declared = pushConstantBytes(shader.code);
  if (declared != pushBytes)
    throw std::logic_error("shader " + std::string(shader.name) + " declares " + std::to_string(declared) +
                           " bytes of push constants, C++ has " + std::to_string(pushBytes));
}

VkPipeline ComputePipeline::handle() {
  if (!pipeline_) make();
  return pipeline_.get();
}

void ComputePipeline::make() {
  const std::string name(shader_.name);
  const VkShaderModuleCreateInfo code{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                      .codeSize = shader_.code.size_bytes(),
                                      .pCode = shader_.code.data()};
  ShaderModule module;
  create(module, device_->handle(), vkCreateShaderModule, code, "loading the shader " + name);
  std::vector<VkSpecializationMapEntry> entries;
  for (uint32_t i = 0; i < constants_.size(); ++i)
    entries.push_back({.constantID = i, .offset = i * 4, .size = 4});
  const VkSpecializationInfo specialization{.mapEntryCount = static_cast<uint32_t>(entries.size()),
                                            .pMapEntries = entries.data(),
                                            .dataSize = constants_.size() * 4,
                                            .pData = constants_.data()};
  const bool isFull = groupSize() % device_->limits().maxSubgroupSize == 0;
  const VkComputePipelineCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
      .flags = VK_PIPELINE_CREATE_DISPATCH_BASE,
      .stage =
          {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
           .flags =
               isFull
                   ? VkPipelineShaderStageCreateFlags{VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT}
                   : 0,
           .stage = VK_SHADER_STAGE_COMPUTE_BIT,
           .module = module.get(),
           .pName = "main",
           .pSpecializationInfo = &specialization},
      .layout = device_->pipelineLayout()};
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(device_->handle(), device_->pipelineCache(), 1, &info, nullptr, &pipeline),
        "making the kernel " + name);
  pipeline_ = {device_->handle(), pipeline};
  device_->setName(VK_OBJECT_TYPE_PIPELINE, pipeline, name);
}

}  // namespace raymap::vulkan
