#pragma once

#include <utility>

#include "vulkan/device/api.h"

namespace raymap::vulkan {

/// Owns an object of a device. `kDestroy` points to the variable that holds Vulkan's destroy function.
template <class T, auto* kDestroy>
class Handle {
 public:
  Handle() = default;
  Handle(VkDevice device, T handle) : device_(device), handle_(handle) {}
  Handle(Handle&& other) noexcept { swap(other); }
  Handle& operator=(Handle&& other) noexcept {
    Handle(std::move(other)).swap(*this);
    return *this;
  }
  ~Handle() {
    if (handle_) (*kDestroy)(device_, handle_, nullptr);
  }

  T get() const { return handle_; }
  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }
  void swap(Handle& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
  }

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  T handle_ = VK_NULL_HANDLE;
};

using BufferHandle = Handle<VkBuffer, &vkDestroyBuffer>;
using CommandPool = Handle<VkCommandPool, &vkDestroyCommandPool>;
using Fence = Handle<VkFence, &vkDestroyFence>;
using Memory = Handle<VkDeviceMemory, &vkFreeMemory>;
using Pipeline = Handle<VkPipeline, &vkDestroyPipeline>;
using PipelineCache = Handle<VkPipelineCache, &vkDestroyPipelineCache>;
using PipelineLayout = Handle<VkPipelineLayout, &vkDestroyPipelineLayout>;
using QueryPool = Handle<VkQueryPool, &vkDestroyQueryPool>;
using ShaderModule = Handle<VkShaderModule, &vkDestroyShaderModule>;

/// Calls `vkCreate...(device, info, nullptr, &handle)`. Throws as `check` does.
template <class T, auto* kDestroy, class Create, class Info>
void create(Handle<T, kDestroy>& handle, VkDevice device, Create function, const Info& info,
            std::string_view what) {
  T raw = VK_NULL_HANDLE;
  check(function(device, &info, nullptr, &raw), what);
  handle = {device, raw};
}

}  // namespace raymap::vulkan
