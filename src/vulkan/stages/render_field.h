#pragma once

#include <array>
#include <optional>

#include "vulkan/device/commands.h"
#include "vulkan/stages/render_field_push.h"

namespace raymap {
struct GridMotion;
struct DrawnScene;
}  // namespace raymap

namespace raymap::vulkan {

/// GPU twin of cpu/render/shade.cpp: draws a scene, one ray of a pixel per invocation.
class RenderFieldStage {
 public:
  /// Destination of a picture. A pixel has 32 bits: red in the lowest byte, then green, blue, 255. Its depth
  /// is the distance from the eye to what it shows, in units of the samples; 0: not wanted.
  struct Pixels {
    VkDeviceAddress colour = 0;
    VkDeviceAddress depth = 0;
    VkDeviceAddress steps = 0;  ///< Takes the sum of the pixels' steps; 0: not wanted.
  };
  /// Samples of the scene's field, x fastest, or of each leaf of a narrow band, in any buffer. `scale` is the
  /// number of the scene's units, spacings, per unit of the samples; a second field has the same.
  struct Samples {
    VkDeviceAddress address = 0;
    float scale = 1.0F;
    VkDeviceAddress values = 0;  ///< Numbers in colour, if the scene has such.
  };

  explicit RenderFieldStage(Device& device);
  /// Makes the kernels for dense fields now, and not while a frame is recorded.
  void makeKernels();

  /// Throws `Error(Unsupported)` if kernels cannot number a field's samples, or the words of a band's index.
  static void checkSize(size_t samples, size_t indexWords);
  /// Throws `Error(Unsupported)` if kernels cannot number what is drawn, or if a ray would need more steps
  /// than the device can run reliably.
  void checkScene(const DrawnScene& scene) const;
  /// Uploads a scene that `checkScene` accepted, before a grid that has moved. `leafIndex` is the address of
  /// `DrawnField::leafIndex`, in the samples' units, if the field is a narrow band.
  void recordScene(Commands& commands, const DrawnScene& scene, int width, int height,
                   const GridMotion& motion, VkDeviceAddress leafIndex = 0);
  /// Draws `count` rows from row `first` on, counted from the top.
  void recordRows(Commands& commands, const Samples& samples, const Pixels& pixels, int first, int count);

 private:
  /// Specialization constants of a kernel.
  struct Variant {
    bool hasNumbers, isBand, countsSteps;
  };
  Kernel<RenderFieldPush>& kernel(const Variant& variant);

  Device* device_;
  std::array<std::optional<Kernel<RenderFieldPush>>, 8> kernels_;  // Made when needed first.
  bool hasNumbers_ = false, isBand_ = false;
  RenderFieldPush push_{};
  DeviceBuffer picture_;
};

}  // namespace raymap::vulkan
