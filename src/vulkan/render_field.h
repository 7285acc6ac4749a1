#pragma once

#include <raymap/render.h>

#include "commands.h"
#include "shared/render_field.h"

namespace raymap {
struct Scene;
}

namespace raymap::vulkan {

/// The CPU's twin (render/shade.cpp): a picture of a scene, a ray of a pixel an invocation.
class RenderField {
 public:
  explicit RenderField(Device& device);

  /// Makes room and brings the scene to where the device can fetch it. Throws `Error(Unsupported)` if a ray
  /// would need more steps than the device can be trusted with.
  void reserve(const Scene& scene, int width, int height);
  /// Fetches the scene,
  void recordScene(Commands& commands);
  /// draws some rows, from the top,
  void recordRows(Commands& commands, int first, int count);
  /// and brings the picture back.
  void recordPicture(Commands& commands);
  /// Once that has run.
  void take(Picture& picture) const;

 private:
  void refuseLongRays(double radius) const;

  Device* device_;
  Kernel<RenderFieldPush> kernel_;
  RenderFieldPush push_{};
  DeviceBuffer uploadedSamples_, samples_, uploadedScene_, scene_, pixels_, picture_;
};

}  // namespace raymap::vulkan
