#pragma once

#include <optional>
#include <vector>

#include "gpu.h"

namespace raymap::view {

/// The images of a window, and a render pass that draws over them.
class Swapchain {
 public:
  explicit Swapchain(const Gpu& gpu);

  /// Makes the images anew for a window of this size in pixels. The device must be idle.
  void resize(VkExtent2D window);
  /// Returns the number of the next image; nothing if the images do not fit the window any more.
  std::optional<uint32_t> acquire(VkSemaphore isFree);
  /// Shows an image. Returns false if the images do not fit the window any more.
  bool present(uint32_t image);

  uint32_t count() const { return uint32_t(images_.size()); }
  VkExtent2D size() const { return size_; }
  VkImage image(uint32_t number) const { return images_[number].handle; }
  /// Returns what must be signalled before an image is shown.
  VkSemaphore isDrawn(uint32_t number) const { return images_[number].isDrawn.get(); }
  /// Returns the pass that keeps what an image holds, and leaves it ready to be shown.
  VkRenderPass overlay() const { return overlay_.get(); }
  void beginOverlay(VkCommandBuffer commands, uint32_t number) const;

 private:
  struct Target {
    VkImage handle = VK_NULL_HANDLE;
    Owned<VkImageView> view;
    Owned<VkFramebuffer> frame;
    Owned<VkSemaphore> isDrawn;
  };

  void chooseFormat();
  void makeOverlay();

  const Gpu& gpu_;
  VkSurfaceFormatKHR format_ = {};
  Owned<VkRenderPass> overlay_;
  Owned<VkSwapchainKHR> chain_;
  std::vector<Target> images_;
  VkExtent2D size_ = {};
};

/// Makes a semaphore.
Owned<VkSemaphore> makeSemaphore(const Gpu& gpu);

}  // namespace raymap::view
