#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/stages/render_field_push.h"

namespace raymap {
struct Scene;
}

namespace raymap::vulkan {

/// Farther than any ray goes, in samples, and its square still is a float.
inline constexpr double kFarthest = 1e15;

/// The CPU's twin (render/shade.cpp): a picture of a scene, a ray of a pixel an invocation.
class RenderFieldStage {
 public:
  /// Samples of the scene's field, x fastest, and how many of the scene's units, spacings, each unit of
  /// theirs is. They may lie in any buffer.
  struct Samples {
    VkDeviceAddress address = 0;
    float scale = 1.0F;
  };

  explicit RenderFieldStage(Device& device);

  /// Throws `Error(Unsupported)` if a ray would need more steps than the device can be trusted with.
  void checkScene(const Scene& scene) const;
  /// Takes a scene that was checked to where rays find it.
  void recordScene(Commands& commands, const Scene& scene, int width, int height);
  /// Draws some of its rows, from the top, to `pixels`: 32 bits each, red in the lowest, then green, blue,
  /// 255.
  void recordRows(Commands& commands, const Samples& samples, VkDeviceAddress pixels, int first, int count);

 private:
  Device* device_;
  Kernel<RenderFieldPush> kernel_;
  RenderFieldPush push_{};
  DeviceBuffer scene_;
};

}  // namespace raymap::vulkan
