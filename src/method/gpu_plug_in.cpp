#include "method/gpu_plug_in.h"

#include <optional>

namespace raymap {

namespace {
constinit std::optional<GpuPlugIn> plugged;
}

void plugIn(const GpuPlugIn& gpu) {
  plugged = gpu;
}

const GpuPlugIn* gpuPlugIn() {
  return plugged ? &*plugged : nullptr;
}

}  // namespace raymap
