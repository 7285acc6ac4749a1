#include "scene/scene.h"
#include "vulkan/device/buffer_range.h"
#include "vulkan/stages/render_field.h"

#include <raymap/vulkan.h>

namespace raymap::vulkan {

struct Renderer::Impl {
  explicit Impl(const DeviceHandles& handles) : device(handles), stage(device) {}
  Device device;
  RenderFieldStage stage;
};

Renderer::Renderer(const DeviceHandles& device) : impl_(std::make_unique<Impl>(device)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::record(VkCommandBuffer commands, const FieldBuffer& field, const RenderOptions& options,
                      const BufferRange& pixels, const BufferRange& depth) {
  validateGrid(field.grid);
  checkPictureSize(options.width, options.height);
  if (!options.frame)
    throw Error(ErrorCode::Usage, "the box of a shape on the device is unknown; give a box to frame");
  if (!field.distance.buffer || !pixels.buffer)
    throw Error(ErrorCode::Usage, "drawing needs buffers of distances and pixels");
  const RenderFieldStage::Samples samples{
      .address = addressOf(impl_->device.handle(), field.distance, "a field of distances"),
      .scale = static_cast<float>(1.0 / field.grid.spacing)};
  RenderFieldStage::Pixels picture{.colour = addressOf(impl_->device.handle(), pixels, "a picture")};
  if (depth.buffer) picture.depth = addressOf(impl_->device.handle(), depth, "a picture's depth");
  const Field elsewhere{.grid = field.grid, .clampDistance = field.clampDistance};
  const Scene scene(elsewhere, options);
  impl_->stage.checkScene(scene);
  Commands work(commands, impl_->device.pipelineLayout(), nullptr);
  waitForAll(commands);
  impl_->stage.recordScene(work, scene, options.width, options.height);
  impl_->stage.recordRows(work, samples, picture, 0, options.height);
  showAll(commands);
}

}  // namespace raymap::vulkan
