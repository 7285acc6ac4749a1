#pragma once

#include "camera.h"
#include "device_mesh.h"

namespace raymap::view {

/// How the mesh is drawn.
enum class MeshStyle { Hidden, Lines, Faces };

/// Draws a mesh over a picture of the field, or by itself.
class MeshPass {
 public:
  explicit MeshPass(const Gpu& gpu);

  struct Target {
    const Image& picture;  ///< In VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL.
    const Image&
        nearest;  ///< Its format is `kDepthFormat`, its layout VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL.
    VkExtent2D size = {};       ///< Part of both images that is drawn.
    VkDeviceAddress depth = 0;  ///< Depth of the field's picture, in rows of `size`; 0: there is none.
  };
  static constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

  /// Records the drawing of what is not beyond the cut, whose normal is a unit vector. `slack` is how far
  /// behind the field's surface a face is still seen. Without a field, clears the picture first.
  void record(VkCommandBuffer commands, const DeviceMesh& mesh, MeshStyle style, const Camera& camera,
              const Box& bounds, const std::optional<Plane>& cut, const Target& target, double slack) const;

 private:
  void makePipeline(const Gpu& gpu);

  Owned<VkPipelineLayout> layout_;
  Owned<VkPipeline> pipeline_;
};

}  // namespace raymap::view
