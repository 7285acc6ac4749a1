// Plugs the Vulkan backend into the core of programs that link raymap::vulkan.

#include <cstdint>
#include <filesystem>

#include "method/gpu_plug_in.h"
#include "shaders/raymap_vulkan_all.h"
#include "vulkan/runtime/backend.h"
#include "vulkan/runtime/draw_scene.h"
#include "vulkan/self_test/self_test.h"

namespace raymap::vulkan {

namespace {

class OpenDevice final : public GpuDevice {
 public:
  explicit OpenDevice(size_t index) : device_({.index = index}) {}

  void generate(const Job& job, Stats& stats) override {
    const size_t limit = job.machine.memoryLimit;
    if (limit != 0) backend_.reset();  // What earlier runs left is part of it.
    device_.limitMemory(limit != 0 ? limit : UINT64_MAX);
    if (!backend_) backend_.emplace(device_);
    backend_->setJob(job);
    runPipeline(*backend_);
    backend_->readResults();
    stats.stages = backend_->stages();
    stats.bytes = device_.heldMemory();
    describeMesh(*backend_, job.grid, stats);
  }

  void draw(const DrawnScene& scene, Progress& progress, Picture& picture) override {
    device_.limitMemory(UINT64_MAX);
    drawScene(device_, scene, progress, picture);
  }

 private:
  Device device_;
  std::optional<Backend> backend_;
};

std::unique_ptr<GpuDevice> openDevice(size_t index) {
  return std::make_unique<OpenDevice>(index);
}

bool mayHaveGpu() {
  std::error_code ignored;
  for (const char* node : {"/dev/dri", "/dev/nvidiactl", "/dev/dxg"})
    if (std::filesystem::exists(node, ignored)) return true;
  return false;
}

uint64_t kernelHash() {
  static const uint64_t hash = hashOf(shaders::kAll);
  return hash;
}

}  // namespace

}  // namespace raymap::vulkan

/// The linker must keep this symbol (src/vulkan/CMakeLists.txt); otherwise it leaves this file of a static
/// library out.
// NOLINTNEXTLINE(readability-identifier-naming): a symbol of the linker.
extern "C" const bool raymapVulkanIsPluggedIn = [] {
  using namespace raymap::vulkan;
  raymap::plugIn({.list = listDevices,
                  .open = openDevice,
                  .test = testDevice,
                  .mayHaveGpu = mayHaveGpu,
                  .kernelHash = kernelHash});
  return true;
}();
