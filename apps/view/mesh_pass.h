#pragma once

#include "camera.h"
#include "device_mesh.h"
#include "mesh_push.h"

namespace raymap::view {

/// How the mesh is drawn.
enum class MeshStyle { Hidden, Lines, Faces };

/// Faces or edges on the device that have one colour.
struct MeshPart {
  VkDeviceAddress indices = 0;  ///< Three vertices of each face, or two of each edge.
  uint32_t count = 0;           ///< Number of faces or edges.
  uint32_t colour = 0;          ///< As in `MeshPush`.
  bool isEdges = false;
};

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

  /// Where one looks from, and what hides parts of the mesh.
  struct View {
    const Camera& camera;
    const Box& bounds;
    const std::optional<Plane>& cut;  ///< Its normal is a unit vector.
    double slack = 0.0;               ///< How far behind the field's surface a face is still seen.
  };
  /// Records the drawing of a mesh and of parts of it over it, the last one on top. Without a field, clears
  /// the picture first.
  void record(VkCommandBuffer commands, const DeviceMesh& mesh, MeshStyle style,
              std::span<const MeshPart> parts, const View& view, const Target& target) const;

 private:
  Owned<VkPipeline> makePipeline(const Gpu& gpu, std::span<const uint32_t> vertexCode,
                                 std::span<const uint32_t> fragmentCode) const;
  void draw(VkCommandBuffer commands, const MeshPart& part, MeshPush push) const;

  Owned<VkPipelineLayout> layout_;
  Owned<VkPipeline> faces_, edges_;
};

}  // namespace raymap::view
