#include "render_field.h"

#include <raymap/error.h>

#include <algorithm>
#include <limits>
#include <string>

#include "cpu/parallel.h"
#include "render/scene.h"
#include "shaders/render_field_spv.h"

namespace raymap::vulkan {

namespace {

/// Farther than any ray goes, and its square still is a float.
constexpr double kFar = 1e15;

/// In samples, as the CPU has them when it draws.
void fillSamples(const Field& field, std::span<float> samples) {
  const double scale = 1.0 / field.grid.spacing;
  parallelFor(samples.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
    for (size_t s = begin; s < end; ++s)
      samples[s] = static_cast<float>(std::clamp(field.distance[s] * scale, -kFar, kFar));
  });
}

RenderShape describe(const Shape& shape) {
  const glm::uvec3 dims(shape.field().grid.dims);
  return {
      .centre = shape.centre(),
      .radius = static_cast<float>(shape.radius()),
      .cutNormal = shape.isCut() ? glm::vec3(shape.cutNormal()) : glm::vec3(0.0f),
      .cutOffset = shape.isCut() ? static_cast<float>(shape.cutOffset()) : std::numeric_limits<float>::max(),
      .level = static_cast<float>(shape.level()),
      .wall = static_cast<float>(std::min(shape.wall(), kFar)),
      .band = static_cast<float>(std::min(shape.band(), kFar)),
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
          .lineStep = static_cast<float>(std::min(scene.lineStep, kFar * kFar)),
          .depth = static_cast<float>(std::min(scene.shape.depth(), kFar)),
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

RenderField::RenderField(Device& device)
    : device_(&device),
      kernel_(device, shaders::kRenderField, kRenderGroup),
      uploadedSamples_(device, "field upload", MemoryUse::Upload),
      samples_(device, "field to draw"),
      uploadedScene_(device, "scene upload", MemoryUse::Upload),
      scene_(device, "scene"),
      pixels_(device, "pixels"),
      picture_(device, "picture for the host", MemoryUse::ReadBack) {}

/// A ray takes up to 40 steps a sample to meet the shape or to miss it, 10 more to the light, both across
/// the ball around it.
void RenderField::refuseLongRays(double radius) const {
  // Drivers in software may end loops after 65,535 turns, without a word. Any other may give up a device
  // that is busy for seconds; and far beyond, a step is too small to change a position.
  const double most = device_->info().type == DeviceType::Software ? 1250.0 : 16384.0;
  if (radius > most)
    throw Error(ErrorCode::Unsupported, "the shape is " + std::to_string(2.0 * radius) + " samples across; " +
                                            device_->info().name + " can draw up to " +
                                            std::to_string(static_cast<int>(2.0 * most)) +
                                            ", draw it on the CPU");
}

void RenderField::reserve(const Scene& scene, int width, int height) {
  const Field& field = scene.shape.field();
  const size_t count = field.distance.size();
  if (count > size_t{std::numeric_limits<int32_t>::max()})
    throw Error(ErrorCode::Unsupported, "the field has " + std::to_string(count) +
                                            " samples; a device draws up to 2147483647, draw it on the CPU");
  refuseLongRays(scene.shape.radius());
  const auto pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  for (DeviceBuffer* buffer : {&samples_, &uploadedSamples_}) buffer->resize<float>(count);
  for (DeviceBuffer* buffer : {&scene_, &uploadedScene_}) buffer->resize<RenderSceneData>(1);
  for (DeviceBuffer* buffer : {&pixels_, &picture_}) buffer->resize<uint32_t>(pixels);
  fillSamples(field, uploadedSamples_.mapped<float>());
  uploadedScene_.mapped<RenderSceneData>()[0] = describe(scene);
  push_ = {.samples = samples_.address(),
           .scene = scene_.address(),
           .pixels = pixels_.address(),
           .shape = describe(scene.shape),
           .width = static_cast<uint32_t>(width),
           .height = static_cast<uint32_t>(height)};
}

void RenderField::recordScene(Commands& commands) {
  commands.concurrent([&] {
    commands.copy(uploadedSamples_, samples_, samples_.bytes());
    commands.copy(uploadedScene_, scene_, scene_.bytes());
  });
}

void RenderField::recordRows(Commands& commands, int first, int count) {
  const auto tiles = [](uint32_t side) { return (uint64_t{side} + kRenderTile - 1) / kRenderTile; };
  push_.firstRow = static_cast<uint32_t>(first);
  push_.rows = static_cast<uint32_t>(count);
  commands.dispatch(kernel_, push_, tiles(push_.width) * tiles(push_.rows) * kRenderGroup);
}

void RenderField::recordPicture(Commands& commands) {
  commands.copy(pixels_, picture_, picture_.bytes());
}

void RenderField::take(Picture& picture) const {
  uint8_t* rgb = picture.rgb.data();
  for (const uint32_t pixel : picture_.mapped<uint32_t>())
    for (const int shift : {0, 8, 16}) *rgb++ = static_cast<uint8_t>(pixel >> shift);
}

}  // namespace raymap::vulkan
