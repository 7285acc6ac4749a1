#pragma once

#include "vulkan/device/api.h"
// After Vulkan's declarations, as it asks.
#include <raymap/vulkan.h>

namespace raymap::vulkan {

/// Where shaders find a range of the caller's; 0 for no buffer. Throws `Error(Usage)` that calls it `name`
/// unless it begins at a multiple of `alignment`.
VkDeviceAddress addressOf(VkDevice device, const BufferRange& range, const char* name,
                          VkDeviceSize alignment = 4);

}  // namespace raymap::vulkan
