#pragma once

#include "vulkan/device/api.h"
// raymap/vulkan.h must follow Vulkan's declarations.
#include <raymap/vulkan_device.h>

namespace raymap::vulkan {

/// Returns the device address of a caller's range; 0 if it has no buffer. Throws `Error(Usage)`, naming the
/// range `name`, unless the address is a multiple of `alignment`.
VkDeviceAddress addressOf(VkDevice device, const BufferRange& range, const char* name,
                          VkDeviceSize alignment = 4);

}  // namespace raymap::vulkan
