#include "vulkan/device/buffer_range.h"

#include <raymap/error.h>

#include <string>

namespace raymap::vulkan {

VkDeviceAddress addressOf(VkDevice device, const BufferRange& range, const char* name,
                          VkDeviceSize alignment) {
  if (range.buffer == VK_NULL_HANDLE) return 0;
  const VkBufferDeviceAddressInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
                                       .buffer = range.buffer};
  const VkDeviceAddress address = vkGetBufferDeviceAddress(device, &info) + range.offset;
  if (address % alignment != 0)
    throw Error(ErrorCode::Usage, std::string(name) + " must lie at a multiple of " +
                                      std::to_string(alignment) + " bytes; its offset is " +
                                      std::to_string(range.offset));
  return address;
}

}  // namespace raymap::vulkan
