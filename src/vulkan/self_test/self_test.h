#pragma once

#include "method/gpu_plug_in.h"

namespace raymap::vulkan {

/// Runs all checks on a device by its number. Ends after the first that fails, or if `report` says so.
void testDevice(size_t index, const DeviceTestReport& report);

}  // namespace raymap::vulkan
