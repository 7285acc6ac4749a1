#include "vulkan/stages/render_field.h"

#include <raymap/error.h>

#include <limits>
#include <string>

#include "base/ceil_div.h"
#include "base/text.h"
#include "picture/drawn_scene.h"
#include "shaders/render_field_spv.h"

namespace raymap::vulkan {

RenderFieldStage::RenderFieldStage(Device& device) : device_(&device), picture_(device, "scene") {
  picture_.resize<RenderPicture>(1);
}

void RenderFieldStage::makeKernels() {
  for (const bool hasNumbers : {false, true}) kernel({hasNumbers, false, false}).handle();
}

void RenderFieldStage::checkSize(size_t samples, size_t indexWords) {
  const auto check = [](size_t count, const char* what) {
    if (count > size_t{std::numeric_limits<int32_t>::max()})
      throw Error(ErrorCode::Unsupported, "the field has " + std::to_string(count) + what +
                                              "; a device draws up to 2147483647, draw it on the CPU");
  };
  check(samples, " samples");
  check(indexWords, " words in the index of its leaves");
}

/// Per sample of the ball's radius, a ray takes up to 40 steps to meet or miss the shape, and 10 more to the
/// light. Both cross the ball around the shape.
void RenderFieldStage::checkScene(const DrawnScene& scene) const {
  checkSize(scene.shape.field().sampleCount(), scene.shape.field().leafIndexCount());
  // Some software drivers silently end loops after 65,535 iterations. Other drivers may give up a device that
  // is busy for seconds. Far beyond this size, a step is too small to change a position.
  const double most = device_->info().type == DeviceType::Software ? 1250.0 : 16384.0;
  if (const double radius = scene.shape.radius(); radius > most)
    throw Error(ErrorCode::Unsupported, "the shape is " + numberText(2.0 * radius) + " samples across; " +
                                            device_->info().name + " can draw up to " +
                                            std::to_string(static_cast<int>(2.0 * most)) +
                                            ", draw it on the CPU");
}

void RenderFieldStage::recordScene(Commands& commands, const DrawnScene& scene, int width, int height,
                                   const GridMotion& motion, VkDeviceAddress leafIndex) {
  hasNumbers_ = scene.numbers.has_value();
  isBand_ = leafIndex != 0;
  push_ = {.picture = picture_.address(),
           .shape = describe(scene.shape),
           .width = static_cast<uint32_t>(width),
           .height = static_cast<uint32_t>(height)};
  RenderPicture picture{describe(scene), describeColours(scene), leafIndex};
  move(motion, push_.shape, picture.scene);
  commands.update(picture_, picture);
}

Kernel<RenderFieldPush>& RenderFieldStage::kernel(const Variant& variant) {
  const uint32_t hasNumbers = variant.hasNumbers, isBand = variant.isBand, countsSteps = variant.countsSteps;
  std::optional<Kernel<RenderFieldPush>>& kernel = kernels_[hasNumbers + 2 * isBand + 4 * countsSteps];
  if (!kernel)
    kernel.emplace(*device_, shaders::kRenderField, kRenderGroup,
                   std::initializer_list<uint32_t>{hasNumbers, isBand, countsSteps});
  return *kernel;
}

void RenderFieldStage::recordRows(Commands& commands, const Samples& samples, const Pixels& pixels, int first,
                                  int count) {
  const auto tiles = [](uint32_t side) { return ceilDiv(side, kRenderTile); };
  push_.samples = samples.address;
  push_.values = samples.values;
  push_.scale = samples.scale;
  push_.pixels = pixels.colour;
  push_.depth = pixels.depth;
  push_.steps = pixels.steps;
  push_.firstRow = static_cast<uint32_t>(first);
  push_.rows = static_cast<uint32_t>(count);
  commands.dispatch(kernel({hasNumbers_, isBand_, pixels.steps != 0}), push_,
                    tiles(push_.width) * tiles(push_.rows) * kRenderGroup);
}

}  // namespace raymap::vulkan
