#pragma once

#include "cells.h"
#include "vulkan/self_test/cell_probe.h"
#include "vulkan_device.h"

namespace raymap::vulkan {

/// Runs the stages over cells on the device of the tests.
class CellStages : public VulkanTest {
 public:
  static CellProbe& probe() {
    shared();  // The device is made before the stages, so it is destroyed after them.
    static CellProbe probe(device());
    return probe;
  }
};

}  // namespace raymap::vulkan
