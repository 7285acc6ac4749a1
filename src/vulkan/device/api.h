#pragma once

#include <string_view>

#include "vulkan_names.h"
// volk.h uses the names that this header redefines.
#include <volk.h>

namespace raymap::vulkan {

/// Opens the Vulkan loader once, at run time, so that programs also start without a loader. Throws
/// `Error(Unsupported)` if there is none.
void openLoader();

/// Loads Vulkan's functions once, through the first instance. The loader's entry points find the driver
/// through the handle they are called with, so they serve every instance and device.
void loadFunctions(VkInstance instance);

/// Throws `Error` unless the result is a success: Memory, DeviceLost, else Unsupported. `what` names the
/// failed operation in the message: "making a pipeline for scan_reduce".
void check(VkResult result, std::string_view what);

}  // namespace raymap::vulkan
