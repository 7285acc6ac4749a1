#include "swapchain.h"

#include <raymap/error.h>

#include <algorithm>

namespace raymap::view {

Owned<VkSemaphore> makeSemaphore(const Gpu& gpu) {
  const VkSemaphoreCreateInfo info{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  VkSemaphore semaphore = VK_NULL_HANDLE;
  check(vkCreateSemaphore(gpu.device(), &info, nullptr, &semaphore), "making a semaphore");
  return own(gpu.device(), semaphore, vkDestroySemaphore);
}

Swapchain::Swapchain(const Gpu& gpu) : gpu_(gpu) {
  chooseFormat();
  makeOverlay();
}

/// Pictures hold sRGB bytes already, so the format must not convert them.
void Swapchain::chooseFormat() {
  uint32_t count = 0;
  const VkPhysicalDevice physical = gpu_.handles().physical;
  check(vkGetPhysicalDeviceSurfaceFormatsKHR(physical, gpu_.surface(), &count, nullptr), "listing formats");
  std::vector<VkSurfaceFormatKHR> formats(count);
  check(vkGetPhysicalDeviceSurfaceFormatsKHR(physical, gpu_.surface(), &count, formats.data()),
        "listing formats");
  const auto found = std::ranges::find_if(formats, [](const VkSurfaceFormatKHR& each) {
    return each.format == VK_FORMAT_B8G8R8A8_UNORM || each.format == VK_FORMAT_R8G8B8A8_UNORM;
  });
  if (found == formats.end())
    throw Error(ErrorCode::Unsupported, "the window has no format of 8 bits a colour; use another device");
  format_ = *found;
}

void Swapchain::makeOverlay() {
  const VkAttachmentDescription attachment{.format = format_.format,
                                           .samples = VK_SAMPLE_COUNT_1_BIT,
                                           .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                           .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                           .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                           .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                           .initialLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                           .finalLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR};
  const VkAttachmentReference colour{.layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkSubpassDescription subpass{.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                     .colorAttachmentCount = 1,
                                     .pColorAttachments = &colour};
  const VkRenderPassCreateInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                    .attachmentCount = 1,
                                    .pAttachments = &attachment,
                                    .subpassCount = 1,
                                    .pSubpasses = &subpass};
  VkRenderPass pass = VK_NULL_HANDLE;
  check(vkCreateRenderPass(gpu_.device(), &info, nullptr, &pass), "making a render pass");
  overlay_ = own(gpu_.device(), pass, vkDestroyRenderPass);
}

void Swapchain::resize(VkExtent2D window) {
  VkSurfaceCapabilitiesKHR can;
  check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(gpu_.handles().physical, gpu_.surface(), &can),
        "asking about the window");
  const bool isFree = can.currentExtent.width == UINT32_MAX;
  size_ = isFree ? window : can.currentExtent;
  size_.width = std::clamp(size_.width, std::max(can.minImageExtent.width, 1u), can.maxImageExtent.width);
  size_.height = std::clamp(size_.height, std::max(can.minImageExtent.height, 1u), can.maxImageExtent.height);
  const uint32_t most = can.maxImageCount > 0 ? can.maxImageCount : UINT32_MAX;
  const VkSwapchainCreateInfoKHR info{
      .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
      .surface = gpu_.surface(),
      .minImageCount = std::min(can.minImageCount + 1, most),
      .imageFormat = format_.format,
      .imageColorSpace = format_.colorSpace,
      .imageExtent = size_,
      .imageArrayLayers = 1,
      .imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
      .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
      .preTransform = can.currentTransform,
      .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
      .presentMode = VK_PRESENT_MODE_FIFO_KHR,
      .clipped = VK_TRUE,
      .oldSwapchain = chain_.get()};
  images_.clear();
  VkSwapchainKHR chain = VK_NULL_HANDLE;
  check(vkCreateSwapchainKHR(gpu_.device(), &info, nullptr, &chain), "making the window's images");
  chain_ = own(gpu_.device(), chain, vkDestroySwapchainKHR);

  uint32_t count = 0;
  check(vkGetSwapchainImagesKHR(gpu_.device(), chain, &count, nullptr), "listing the window's images");
  std::vector<VkImage> images(count);
  check(vkGetSwapchainImagesKHR(gpu_.device(), chain, &count, images.data()), "listing the window's images");
  for (const VkImage image : images) {
    Target& target = images_.emplace_back();
    target.handle = image;
    const VkImageViewCreateInfo viewInfo{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                         .image = image,
                                         .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                         .format = format_.format,
                                         .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    VkImageView view = VK_NULL_HANDLE;
    check(vkCreateImageView(gpu_.device(), &viewInfo, nullptr, &view), "making a view of an image");
    target.view = own(gpu_.device(), view, vkDestroyImageView);
    const VkFramebufferCreateInfo frameInfo{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                            .renderPass = overlay_.get(),
                                            .attachmentCount = 1,
                                            .pAttachments = &view,
                                            .width = size_.width,
                                            .height = size_.height,
                                            .layers = 1};
    VkFramebuffer frame = VK_NULL_HANDLE;
    check(vkCreateFramebuffer(gpu_.device(), &frameInfo, nullptr, &frame), "making a frame buffer");
    target.frame = own(gpu_.device(), frame, vkDestroyFramebuffer);
    target.isDrawn = makeSemaphore(gpu_);
  }
}

std::optional<uint32_t> Swapchain::acquire(VkSemaphore isFree) {
  uint32_t number = 0;
  const VkResult result =
      vkAcquireNextImageKHR(gpu_.device(), chain_.get(), UINT64_MAX, isFree, VK_NULL_HANDLE, &number);
  if (result == VK_ERROR_OUT_OF_DATE_KHR) return {};
  if (result != VK_SUBOPTIMAL_KHR) check(result, "taking an image of the window");
  return number;
}

bool Swapchain::present(uint32_t image) {
  const VkSemaphore isDrawn = images_[image].isDrawn.get();
  const VkSwapchainKHR chain = chain_.get();
  const VkPresentInfoKHR info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                              .waitSemaphoreCount = 1,
                              .pWaitSemaphores = &isDrawn,
                              .swapchainCount = 1,
                              .pSwapchains = &chain,
                              .pImageIndices = &image};
  const VkResult result = vkQueuePresentKHR(gpu_.handles().queue, &info);
  if (result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR) return false;
  check(result, "showing an image");
  return true;
}

void Swapchain::beginOverlay(VkCommandBuffer commands, uint32_t number) const {
  const VkRenderPassBeginInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                   .renderPass = overlay_.get(),
                                   .framebuffer = images_[number].frame.get(),
                                   .renderArea = {.extent = size_}};
  vkCmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
}

}  // namespace raymap::view
