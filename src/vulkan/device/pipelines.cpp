#include "vulkan/device/pipelines.h"

#include <raymap/error.h>

#include <algorithm>
#include <string>

#include "base/parallel.h"
#include "vulkan/device/device.h"

namespace raymap::vulkan {

bool PipelineSource::operator==(const PipelineSource& other) const {
  return shader.code.data() == other.shader.code.data() && constants == other.constants &&
         hasFullSubgroups == other.hasFullSubgroups;
}

Pipelines::Pipelines(const Device& device, const std::optional<PipelineCacheFile>& file)
    : device_(device), file_(file) {
  const std::vector<std::byte> known = file_ ? file_->read() : std::vector<std::byte>();
  const VkPipelineCacheCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
                                       .initialDataSize = known.size(),
                                       .pInitialData = known.data()};
  create(cache_, device_.handle(), vkCreatePipelineCache, info, "making a pipeline cache");
}

Pipelines::~Pipelines() {
  if (file_ && hasMade_) save();
}

size_t Pipelines::add(PipelineSource source) {
  const auto equal = [&](const Entry& entry) { return entry.source == source; };
  const auto found = std::find_if(entries_.begin(), entries_.end(), equal);
  if (found != entries_.end()) return static_cast<size_t>(found - entries_.begin());
  entries_.push_back({std::move(source), {}});
  return entries_.size() - 1;
}

VkPipeline Pipelines::at(size_t number) {
  Entry& entry = entries_[number];
  if (!entry.pipeline) makeMissing();
  if (!entry.pipeline) entry.pipeline = make(entry.source);  // Throws what kept it from being made.
  return entry.pipeline.get();
}

void Pipelines::makeMissing() {
  hasMade_ = true;
  parallelFor(entries_.size(), 1, [&](size_t begin, size_t end) {
    for (size_t e = begin; e < end; ++e) {
      if (entries_[e].pipeline) continue;
      try {
        entries_[e].pipeline = make(entries_[e].source);
      } catch (const Error&) {
        entries_[e].pipeline = {};  // This run may not need it.
      }
    }
  });
}

Pipeline Pipelines::make(const PipelineSource& source) const {
  const std::string name(source.shader.name);
  const VkShaderModuleCreateInfo code{.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                      .codeSize = source.shader.code.size_bytes(),
                                      .pCode = source.shader.code.data()};
  ShaderModule module;
  create(module, device_.handle(), vkCreateShaderModule, code, "loading the shader " + name);
  std::vector<VkSpecializationMapEntry> constants;
  for (uint32_t i = 0; i < source.constants.size(); ++i)
    constants.push_back({.constantID = i, .offset = i * 4, .size = 4});
  const VkSpecializationInfo specialization{.mapEntryCount = static_cast<uint32_t>(constants.size()),
                                            .pMapEntries = constants.data(),
                                            .dataSize = source.constants.size() * 4,
                                            .pData = source.constants.data()};
  constexpr VkPipelineShaderStageCreateFlags kFull =
      VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT;
  const VkComputePipelineCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
      .flags = VK_PIPELINE_CREATE_DISPATCH_BASE,
      .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                .flags = source.hasFullSubgroups ? kFull : 0,
                .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                .module = module.get(),
                .pName = "main",
                .pSpecializationInfo = &specialization},
      .layout = device_.pipelineLayout()};
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(device_.handle(), cache_.get(), 1, &info, nullptr, &pipeline),
        "making the kernel " + name);
  device_.setName(VK_OBJECT_TYPE_PIPELINE, pipeline, name);
  return {device_.handle(), pipeline};
}

/// Stores what the driver compiled. Nothing fails if that is impossible.
void Pipelines::save() const {
  size_t size = 0;
  if (vkGetPipelineCacheData(device_.handle(), cache_.get(), &size, nullptr) != VK_SUCCESS) return;
  std::vector<std::byte> data(size);
  if (vkGetPipelineCacheData(device_.handle(), cache_.get(), &size, data.data()) != VK_SUCCESS) return;
  data.resize(size);
  file_->write(data);
}

}  // namespace raymap::vulkan
