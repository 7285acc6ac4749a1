#pragma once

#include "vulkan/device/device.h"

namespace raymap::bench {

/// Prints what steps cost that do no work, and what the host waits besides the device's work.
void printLatencies(vulkan::Device& device);

}  // namespace raymap::bench
