#pragma once

// Types of raymap/vulkan.h for devices, buffers and lists.

#include <raymap/export.h>
#include <vulkan/vulkan_core.h>

#include <cstdint>

namespace raymap::vulkan {

/// A device and one of its queues.
struct DeviceHandles {
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  uint32_t queueFamily = 0;  ///< Family of the command buffers to record into; it must support compute.
  VkQueue queue = VK_NULL_HANDLE;
};

/// Switches on the features that a device needs for raymap, and leaves all others alone. The device also
/// needs Vulkan 1.3, as does the instance, and no extension.
RAYMAP_API void requireFeatures(VkPhysicalDeviceFeatures& v10, VkPhysicalDeviceVulkan12Features& v12,
                                VkPhysicalDeviceVulkan13Features& v13);

/// The caller's buffer from a byte on.
struct BufferRange {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;  ///< In bytes, a multiple of 4.
};

/// Lengths of the lists behind the paper's distances (Krayer & Müller 2019, §3.1), known to the device only.
struct ListSizes {
  uint64_t rows = 0;     ///< Number of rows of cells that the triangles' bounds touch.
  uint64_t entries = 0;  ///< Number of pairs of a cell and a triangle in it.
};

}  // namespace raymap::vulkan
