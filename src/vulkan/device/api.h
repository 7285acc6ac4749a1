#pragma once

#include <string_view>

#include "vulkan_names.h"
// After the names.
#include <volk.h>

namespace raymap::vulkan {

/// Opens the Vulkan loader, once. It is opened at run time so that programs start where there is none; then
/// this throws `Error(Unsupported)`.
void openLoader();

/// Fetches Vulkan's functions, once, through whichever instance comes first: the loader's entry points find
/// the driver through the handle they are given, so they serve every instance and device.
void loadFunctions(VkInstance instance);

/// Throws `Error` unless the result is a success: Memory, DeviceLost, else Unsupported. `what` says what was
/// tried: "making a pipeline for scan_reduce".
void check(VkResult result, std::string_view what);

}  // namespace raymap::vulkan
