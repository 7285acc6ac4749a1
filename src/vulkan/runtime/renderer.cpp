#include "base/require.h"
#include "picture/drawn_scene.h"
#include "vulkan/device/buffer_range.h"
#include "vulkan/stages/render_field.h"

#include <raymap/vulkan.h>

#include <cmath>
#include <string>

namespace raymap::vulkan {

namespace {

/// Returns the inverse of the field's motion, in samples.
GridMotion motionOf(const FieldBuffer& field) {
  const glm::dquat rotation = glm::normalize(field.rotation);
  const glm::dvec3 translation = field.translation, origin = field.grid.origin;
  const double sum = rotation.x + rotation.y + rotation.z + rotation.w;
  if (!std::isfinite(sum + translation.x + translation.y + translation.z) ||
      glm::length(field.rotation) == 0.0)
    throw Error(ErrorCode::Usage, "the motion of a field must be finite, and its rotation not 0");
  const glm::dmat3 back = glm::mat3_cast(glm::conjugate(rotation));
  return {.turn = back, .shift = (back * (origin - translation) - origin) / field.grid.spacing};
}

}  // namespace

std::vector<uint32_t> packLeafIndex(const Field& band) {
  requireNarrow(band);
  validate(band);
  const DrawnField drawn(band);
  // Later, nobody knows the number of leaves that the device holds.
  RenderFieldStage::checkSize(drawn.sampleCount(), drawn.leafIndexCount());
  return drawn.leafIndex(1.0);
}

struct Renderer::Impl {
  explicit Impl(const DeviceHandles& handles) : device(handles), stage(device) { stage.makeKernels(); }
  Device device;
  RenderFieldStage stage;
};

Renderer::Renderer(const DeviceHandles& device) : impl_(std::make_unique<Impl>(device)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::record(VkCommandBuffer commands, const FieldBuffer& field, const RenderOptions& options,
                      const PictureTarget& target) {
  require(commands != VK_NULL_HANDLE, "no command buffer is given");
  validateGrid(field.grid);
  checkPictureSize(options.width, options.height);
  if (!options.frame)
    throw Error(ErrorCode::Usage, "the box of a shape on the device is unknown; give a box to frame");
  if (!field.distance.buffer || !target.pixels.buffer)
    throw Error(ErrorCode::Usage, "drawing needs buffers of distances and pixels");
  const int rows = target.rows > 0 ? target.rows : options.height - target.firstRow;
  if (target.firstRow < 0 || target.rows < 0 || rows < 1 || rows > options.height - target.firstRow)
    throw Error(ErrorCode::Usage, "rows " + std::to_string(target.firstRow) + " to " +
                                      std::to_string(target.firstRow + target.rows) +
                                      " are not in a picture of " + std::to_string(options.height));
  RenderFieldStage::Samples samples{
      .address = addressOf(notMoved(impl_).device.handle(), field.distance, "a field of distances"),
      .scale = static_cast<float>(1.0 / field.grid.spacing)};
  RenderFieldStage::Pixels picture{
      .colour = addressOf(notMoved(impl_).device.handle(), target.pixels, "a picture")};
  if (target.depth.buffer)
    picture.depth = addressOf(notMoved(impl_).device.handle(), target.depth, "a picture's depth");
  if (target.steps.buffer)
    picture.steps = addressOf(notMoved(impl_).device.handle(), target.steps, "a number of steps");
  const GridMotion motion = motionOf(field);
  const Field elsewhere{.grid = field.grid, .clampDistance = field.clampDistance};
  RenderOptions shown = options;
  shown.other = nullptr;
  if (field.values.buffer) {
    samples.values = addressOf(notMoved(impl_).device.handle(), field.values, "numbers in colour");
    if (options.array == FieldArray::Distance) shown.other = &elsewhere;
  } else if (options.array != FieldArray::Distance) {
    throw Error(ErrorCode::Usage, "drawing an array in colour needs a buffer of its numbers");
  }
  const BandBuffer& band = field.band;
  const bool isBand = band.leafIndex.buffer != VK_NULL_HANDLE;
  if (isBand && shown.other)
    throw Error(ErrorCode::Usage, "a device draws no difference from a narrow band; draw it on the CPU");
  const VkDeviceAddress leafIndex =
      isBand ? addressOf(notMoved(impl_).device.handle(), band.leafIndex, "the index of leaves") : 0;
  const DrawnScene scene(isBand ? DrawnField(elsewhere, band.inside, band.outside) : DrawnField(elsewhere),
                         shown);
  notMoved(impl_).stage.checkScene(scene);
  Commands work(commands, notMoved(impl_).device.pipelineLayout(), nullptr);
  waitForAll(commands);
  notMoved(impl_).stage.recordScene(work, scene, options.width, options.height, motion, leafIndex);
  notMoved(impl_).stage.recordRows(work, samples, picture, target.firstRow, rows);
  showAll(commands);
}

}  // namespace raymap::vulkan
