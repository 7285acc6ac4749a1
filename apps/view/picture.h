#pragma once

#include <array>

#include "live_field.h"
#include "mesh_pass.h"

namespace raymap::view {

/// The picture of a field and a mesh, on the device. It is drawn coarsely while things move, as the device's
/// speed demands, and finely in several frames when they rest.
class LivePicture {
 public:
  explicit LivePicture(const Gpu& gpu);

  /// Makes room for pictures of this size. The device must be idle.
  void resize(VkExtent2D size);

  struct Input {
    const LiveField& field;
    const LiveField* other = nullptr;  ///< Field whose difference is in colour; null: none.
    bool isFieldShown = true;
    const DeviceMesh* mesh = nullptr;  ///< Null: there is none.
    MeshStyle style = MeshStyle::Hidden;
    std::span<const MeshPart> parts = {};  ///< Parts of the mesh in colour.
    const DeviceMesh* overlaid = nullptr;  ///< Mesh seen where it sticks out of the field; null: none.
    bool countsSteps = false;              ///< Whether to count the steps of rays.
    const Camera& camera;
    const RenderOptions& view;  ///< All but its size is used.
    const Box& bounds;
  };
  /// Records the next step. `hasChanged` says whether the input is another one than last time.
  void record(Frame& frame, const Input& input, bool hasChanged);
  /// Returns whether the picture is as fine as the window, and up to date.
  bool isFinished() const { return isFinished_; }
  /// Returns the share that is drawn of the finest picture.
  double share() const { return isFinished_ ? 1.0 : divisor_ == 1 ? double(nextRow_) / size_.height : 0.0; }

  /// Stretches the picture over an image in VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, from `left` on.
  void copyTo(VkCommandBuffer commands, VkImage target, int32_t left) const;
  /// Copies the depth at a point of the picture to a buffer of a float, if it is in the picture.
  void copyDepth(VkCommandBuffer commands, const glm::dvec2& cursor, const Buffer& to) const;
  /// Copies the number of steps of the picture that is drawn, or 0, to a buffer.
  void copySteps(VkCommandBuffer commands, const Buffer& to) const;
  /// Returns the number of pixels whose steps were counted so far.
  size_t countedPixels() const { return counted_; }
  /// Copies the pixels to a buffer of 32 bits each.
  void copyPixels(VkCommandBuffer commands, const Buffer& to) const;
  VkExtent2D size() const { return size_; }

 private:
  static constexpr uint32_t kCoarsest = 8;

  VkExtent2D sizeAt(uint32_t divisor) const;
  const Image& picture() const { return pictures_[shownDivisor_]; }
  uint32_t liveDivisor() const;
  void drawRows(Frame& frame, const Input& input);
  void show(Frame& frame, const Input& input);

  const Gpu& gpu_;
  vulkan::Renderer renderer_;
  MeshPass meshPass_;
  VkExtent2D size_ = {}, shown_ = {};
  Buffer pixels_, depth_, shownDepth_, steps_;
  size_t counted_ = 0;  ///< Pixels of the number in `steps_`.
  /// Pictures by their divisor. Each has its own size: what stretches one would else mix in pixels beside it.
  std::array<Image, kCoarsest + 1> pictures_;
  Image nearest_;
  uint32_t shownDivisor_ = 0;  ///< Divisor of the picture that is shown.
  bool isFinished_ = false;
  uint32_t divisor_ = 1;  ///< Pixels of the window along a side of a pixel that is drawn now.
  int nextRow_ = 0;
  double pixelsPerMillisecond_ = 2000.0;
};

}  // namespace raymap::view
