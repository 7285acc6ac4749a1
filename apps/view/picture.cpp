#include "picture.h"

#include <algorithm>
#include <cmath>

namespace raymap::view {

namespace {

constexpr double kLivePictureMilliseconds = 40.0;  // Time of a picture while things move.
constexpr double kBandMilliseconds = 60.0;         // Time of a part of one while they rest.
constexpr uint32_t kOverlaid = 0xff3c9bf0u;        // Orange.
// How far behind the field's surface a mesh is seen, in samples: the shape's own, and one that is laid over
// it, whose surface is often the same.
constexpr double kBehindSurface = 2.0, kSticksOut = -1.0;
constexpr VkFormat kFormat = VK_FORMAT_R8G8B8A8_UNORM;
constexpr VkImageLayout kRest = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;  // Between frames.

}  // namespace

LivePicture::LivePicture(const Gpu& gpu)
    : gpu_(gpu), renderer_(gpu.handles()), meshPass_(gpu), steps_(gpu.makeBuffer(sizeof(uint32_t))) {}

void LivePicture::resize(VkExtent2D size) {
  size_ = size;
  shown_ = {};
  isFinished_ = false;
  const VkDeviceSize bytes = VkDeviceSize{4} * size.width * size.height;
  for (Buffer* buffer : {&pixels_, &depth_, &shownDepth_}) *buffer = gpu_.makeBuffer(bytes);
  for (uint32_t divisor = 1; divisor <= kCoarsest; ++divisor)
    pictures_[divisor] = gpu_.makeImage(sizeAt(divisor), kFormat,
                                        VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                            VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT,
                                        VK_IMAGE_ASPECT_COLOR_BIT);
  nearest_ = gpu_.makeImage(size, MeshPass::kDepthFormat, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                            VK_IMAGE_ASPECT_DEPTH_BIT);
}

VkExtent2D LivePicture::sizeAt(uint32_t divisor) const {
  return {std::max(size_.width / divisor, 1u), std::max(size_.height / divisor, 1u)};
}

uint32_t LivePicture::liveDivisor() const {
  const double pixels = double(size_.width) * size_.height;
  const double divisor = std::sqrt(pixels / (pixelsPerMillisecond_ * kLivePictureMilliseconds));
  return std::clamp(uint32_t(std::ceil(divisor)), 1u, kCoarsest);
}

void LivePicture::record(Frame& frame, const Input& input, bool hasChanged) {
  for (const Frame::Time& time : frame.times())
    if (time.stage == std::string_view("picture") && frame.pixels > 0 && time.milliseconds > 0.0)
      pixelsPerMillisecond_ = double(frame.pixels) / time.milliseconds;
  frame.pixels = 0;
  if (hasChanged) {
    divisor_ = liveDivisor();
    nextRow_ = 0;
    isFinished_ = false;
  }
  if (isFinished_ || (input.isFieldShown && !input.field.isReady())) return;
  const bool isDrawn = input.isFieldShown;
  if (isDrawn)
    drawRows(frame, input);
  else
    divisor_ = 1;  // A mesh alone is fast.
  if (isDrawn && nextRow_ < int(sizeAt(divisor_).height)) return;
  show(frame, input);
  isFinished_ = divisor_ == 1;
  divisor_ = std::max(divisor_ / 2, 1u);
  nextRow_ = 0;
}

void LivePicture::drawRows(Frame& frame, const Input& input) {
  const VkExtent2D size = sizeAt(divisor_);
  const bool isLive = divisor_ >= liveDivisor();
  const int left = int(size.height) - nextRow_;
  const double band = kBandMilliseconds * pixelsPerMillisecond_ / size.width;
  const int rows = isLive ? left : std::clamp(int(band), std::min(left, 8), left);
  vulkan::FieldBuffer field = input.field.buffer();
  // While fields are made anew, their grids may differ.
  const bool isComparable = input.other && input.other->isReady() && input.other->grid() == field.grid;
  if (input.view.array == FieldArray::Distance)
    field.values = isComparable ? input.other->buffer().distance : vulkan::BufferRange{};
  RenderOptions view = input.view;
  view.width = int(size.width);
  view.height = int(size.height);
  if (nextRow_ == 0) {
    counted_ = 0;
    vkCmdFillBuffer(frame.commands(), steps_.handle.get(), 0, VK_WHOLE_SIZE, 0);
  }
  renderer_.record(frame.commands(), field, view,
                   {.pixels = pixels_.range(),
                    .depth = depth_.range(),
                    .steps = input.countsSteps ? steps_.range() : vulkan::BufferRange{},
                    .firstRow = nextRow_,
                    .rows = rows});
  frame.pixels = size_t(rows) * size.width;
  if (input.countsSteps) counted_ += frame.pixels;
  frame.stamp("picture");
  nextRow_ += rows;
}

void LivePicture::show(Frame& frame, const Input& input) {
  const VkCommandBuffer commands = frame.commands();
  shown_ = sizeAt(divisor_);
  shownDivisor_ = divisor_;
  const auto move = [&](VkImageLayout from, VkImageLayout to) {
    moveImage(commands, picture().handle.get(), from, to);
  };
  if (input.isFieldShown) {
    move(VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    const VkBufferImageCopy part{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                 .imageExtent = {shown_.width, shown_.height, 1}};
    vkCmdCopyBufferToImage(commands, pixels_.handle.get(), picture().handle.get(),
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &part);
    const VkBufferCopy depths{.size = VkDeviceSize{4} * shown_.width * shown_.height};
    vkCmdCopyBuffer(commands, depth_.handle.get(), shownDepth_.handle.get(), 1, &depths);
    barrier(commands);
  } else {
    // Nothing is there: the largest float.
    vkCmdFillBuffer(commands, shownDepth_.handle.get(), 0, VK_WHOLE_SIZE, 0x7f7fffffu);
    barrier(commands);
  }
  move(input.isFieldShown ? VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
       VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
  const auto drawMesh = [&](const DeviceMesh& mesh, MeshStyle style, std::span<const MeshPart> parts,
                            double slack) {
    moveImage(commands, nearest_.handle.get(), VK_IMAGE_LAYOUT_UNDEFINED,
              VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, VK_IMAGE_ASPECT_DEPTH_BIT);
    meshPass_.record(commands, mesh, style, parts,
                     {.camera = input.camera,
                      .bounds = input.bounds,
                      .cut = input.view.cutPlane,
                      .slack = slack * input.field.grid().spacing},
                     {.picture = picture(),
                      .nearest = nearest_,
                      .size = shown_,
                      .depth = input.isFieldShown ? shownDepth_.address : 0});
    move(VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
    frame.stamp("mesh");
  };
  if (input.overlaid && input.isFieldShown) {
    const MeshPart faces{.indices = input.overlaid->triangles().address,
                         .count = input.overlaid->triangleCount(),
                         .colour = kOverlaid};
    drawMesh(*input.overlaid, MeshStyle::Hidden, {&faces, 1}, kSticksOut);
  }
  if (input.mesh && (!input.isFieldShown || input.style != MeshStyle::Hidden || !input.parts.empty()))
    drawMesh(*input.mesh, input.style, input.parts, kBehindSurface);
  move(VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, kRest);
}

void LivePicture::copyTo(VkCommandBuffer commands, VkImage target, int32_t left) const {
  if (shown_.width == 0) {
    const VkClearColorValue colour{.float32 = {0.94F, 0.945F, 0.955F, 1.0F}};
    const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdClearColorImage(commands, target, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &colour, 1, &all);
    return;
  }
  const VkImageBlit whole{
      .srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
      .srcOffsets = {{}, {int32_t(shown_.width), int32_t(shown_.height), 1}},
      .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
      .dstOffsets = {{left, 0, 0}, {left + int32_t(size_.width), int32_t(size_.height), 1}}};
  vkCmdBlitImage(commands, picture().handle.get(), kRest, target, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                 &whole, VK_FILTER_LINEAR);
}

void LivePicture::copyDepth(VkCommandBuffer commands, const glm::dvec2& cursor, const Buffer& to) const {
  const glm::dvec2 place = cursor / glm::dvec2(size_.width, size_.height);
  if (shown_.width == 0 || !(place.x >= 0.0 && place.x < 1.0 && place.y >= 0.0 && place.y < 1.0)) return;
  const glm::uvec2 pixel(place * glm::dvec2(shown_.width, shown_.height));
  const VkBufferCopy one{.srcOffset = VkDeviceSize{4} * (VkDeviceSize{pixel.y} * shown_.width + pixel.x),
                         .size = 4};
  vkCmdCopyBuffer(commands, shownDepth_.handle.get(), to.handle.get(), 1, &one);
  barrier(commands);
}

void LivePicture::copySteps(VkCommandBuffer commands, const Buffer& to) const {
  const VkBufferCopy one{.size = sizeof(uint32_t)};
  vkCmdCopyBuffer(commands, steps_.handle.get(), to.handle.get(), 1, &one);
  barrier(commands);
}

void LivePicture::copyPixels(VkCommandBuffer commands, const Buffer& to) const {
  const VkBufferImageCopy all{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                              .imageExtent = {shown_.width, shown_.height, 1}};
  vkCmdCopyImageToBuffer(commands, picture().handle.get(), kRest, to.handle.get(), 1, &all);
  barrier(commands);
}

}  // namespace raymap::view
