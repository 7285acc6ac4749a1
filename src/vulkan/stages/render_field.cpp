#include "vulkan/stages/render_field.h"

#include <raymap/error.h>

#include <algorithm>
#include <limits>
#include <string>

#include "base/ceil_div.h"
#include "base/text.h"
#include "scene/scene.h"
#include "scene/sphere_trace_shared.h"
#include "shaders/render_field_spv.h"

namespace raymap::vulkan {

namespace {

RenderShape describe(const Shape& shape) {
  const glm::uvec3 dims(shape.field().grid.dims);
  return {
      .centre = shape.centre(),
      .radius = static_cast<float>(shape.radius()),
      .cutNormal = shape.isCut() ? glm::vec3(shape.cutNormal()) : glm::vec3(0.0f),
      .cutOffset = shape.isCut() ? static_cast<float>(shape.cutOffset()) : std::numeric_limits<float>::max(),
      .level = static_cast<float>(shape.level()),
      .wall = static_cast<float>(std::min(shape.wall(), kFarthestRay)),
      .band = static_cast<float>(std::min(shape.band(), kFarthestRay)),
      .nx = dims.x,
      .ny = dims.y,
      .nz = dims.z};
}

RenderSceneData describe(const Scene& scene) {
  const Camera& camera = scene.camera;
  return {.eye = camera.eye(),
          .right = camera.right(),
          .up = camera.up(),
          .forward = camera.forward(),
          .floorNormal = scene.up,
          .floorHeight = static_cast<float>(camera.floor()),
          .toLight = scene.toLight,
          .pixelAngle = static_cast<float>(camera.pixelAngle()),
          .lineStep = static_cast<float>(std::min(scene.lineStep, kFarthestRay * kFarthestRay)),
          .depth = static_cast<float>(std::min(scene.shape.depth(), kFarthestRay)),
          .sun = kSun,
          .sky = kSky,
          .bounce = kBounce,
          .clay = kClay,
          .top = kBackgroundTop,
          .bottom = kBackgroundBottom,
          .inside = {kInside[0], kInside[1], kInside[2]},
          .contour = kContour};
}

}  // namespace

RenderFieldStage::RenderFieldStage(Device& device)
    : device_(&device), kernel_(device, shaders::kRenderField, kRenderGroup), scene_(device, "scene") {
  scene_.resize<RenderSceneData>(1);
  kernel_.handle();  // Makes the kernel now, not while a frame is recorded.
}

/// Per sample of the ball's radius, a ray takes up to 40 steps to meet or miss the shape, and 10 more to the
/// light. Both cross the ball around the shape.
void RenderFieldStage::checkScene(const Scene& scene) const {
  const size_t count = scene.shape.field().grid.sampleCount();
  if (count > size_t{std::numeric_limits<int32_t>::max()})
    throw Error(ErrorCode::Unsupported, "the field has " + std::to_string(count) +
                                            " samples; a device draws up to 2147483647, draw it on the CPU");
  // Some software drivers silently end loops after 65,535 iterations. Other drivers may give up a device that
  // is busy for seconds. Far beyond this size, a step is too small to change a position.
  const double most = device_->info().type == DeviceType::Software ? 1250.0 : 16384.0;
  if (const double radius = scene.shape.radius(); radius > most)
    throw Error(ErrorCode::Unsupported, "the shape is " + numberText(2.0 * radius) + " samples across; " +
                                            device_->info().name + " can draw up to " +
                                            std::to_string(static_cast<int>(2.0 * most)) +
                                            ", draw it on the CPU");
}

void RenderFieldStage::recordScene(Commands& commands, const Scene& scene, int width, int height) {
  push_ = {.scene = scene_.address(),
           .shape = describe(scene.shape),
           .width = static_cast<uint32_t>(width),
           .height = static_cast<uint32_t>(height)};
  commands.update(scene_, describe(scene));
}

void RenderFieldStage::recordRows(Commands& commands, const Samples& samples, VkDeviceAddress pixels,
                                  int first, int count) {
  const auto tiles = [](uint32_t side) { return ceilDiv(side, kRenderTile); };
  push_.samples = samples.address;
  push_.scale = samples.scale;
  push_.pixels = pixels;
  push_.firstRow = static_cast<uint32_t>(first);
  push_.rows = static_cast<uint32_t>(count);
  commands.dispatch(kernel_, push_, tiles(push_.width) * tiles(push_.rows) * kRenderGroup);
}

}  // namespace raymap::vulkan
