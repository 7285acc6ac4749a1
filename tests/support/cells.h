#pragma once

// The meshes in cell units that the self-test of a GPU makes, too.

#include "base/parallel.h"
#include "vulkan/self_test/cells.h"  // IWYU pragma: export

namespace raymap {

using namespace cpu;

}  // namespace raymap
