#pragma once

#include "method/gpu_plug_in.h"

namespace raymap::vulkan {

/// Runs all checks on a device by its number. Ends after one that loses the device, or if `report` says so.
void testDevice(size_t index, const DeviceTestReport& report);

}  // namespace raymap::vulkan
