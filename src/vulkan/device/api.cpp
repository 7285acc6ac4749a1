#include "vulkan/device/api.h"

#include <raymap/error.h>

#include <mutex>
#include <string>

#include "base/memory.h"

namespace raymap::vulkan {

void openLoader() {
  allowAllocations();  // Drivers map far more than they use.
  static const VkResult result = volkInitialize();
  if (result != VK_SUCCESS)
    throw Error(ErrorCode::Unsupported, "there is no Vulkan loader (libvulkan.so.1); install libvulkan1");
}

void loadFunctions(VkInstance instance) {
  static std::once_flag isLoaded;
  std::call_once(isLoaded, [instance] { volkLoadInstance(instance); });
}

void check(VkResult result, std::string_view what) {
  if (result == VK_SUCCESS) return;
  const std::string failed(what);
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      throw Error(ErrorCode::Memory, failed + ": the host has no memory left; use a lower resolution");
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      throw Error(ErrorCode::DeviceMemory,
                  failed + ": the device has no memory left; use a lower resolution");
    case VK_ERROR_DEVICE_LOST:
      throw Error(ErrorCode::DeviceLost,
                  failed +
                      ": the device stopped answering; it was reset, taken away, or the work took longer "
                      "than the system allows. Restart with a lower resolution or on the CPU");
    default:
      throw Error(ErrorCode::Unsupported, failed + ": the driver answers with VkResult " +
                                              std::to_string(result) + "; update it or use another device");
  }
}

}  // namespace raymap::vulkan
