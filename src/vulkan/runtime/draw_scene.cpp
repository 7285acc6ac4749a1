#include "vulkan/runtime/draw_scene.h"

#include <algorithm>
#include <span>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "picture/drawn_scene.h"
#include "picture/sphere_trace_shared.h"
#include "vulkan/device/command_buffer.h"
#include "vulkan/stages/render_field.h"

namespace raymap::vulkan {

namespace {

/// Number of rows to draw at once: few enough that cancelling is prompt and the system gets the device in
/// between, and many enough to keep the device busy.
class Bands {
 public:
  int rows() const { return rows_; }
  /// Calls `draw` and adapts the number of rows to the time it takes.
  template <class Draw>
  void time(Draw&& draw) {
    const Stopwatch stopwatch;
    draw();
    const double took = stopwatch.milliseconds();
    if (took < 50.0) rows_ *= 2;
    if (took > 200.0) rows_ = std::max(rows_ / 2, kLeast);
  }

 private:
  static constexpr int kLeast = kRenderTile;
  int rows_ = 8 * kLeast;
};

/// Scales numbers, as the CPU does when it draws.
void fillSamples(const raymap::Buffer<float>& numbers, double scale, std::span<float> samples) {
  parallelFor(numbers.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
    for (size_t s = begin; s < end; ++s)
      samples[s] = static_cast<float>(std::clamp(numbers[s] * scale, -kFarthestRay, kFarthestRay));
  });
}

/// Buffers for a field on its way to the device and a picture on its way back.
struct Buffers {
  Buffers(Device& device, size_t samples, bool hasValues, std::span<const uint32_t> leafIndex,
          size_t pixelCount)
      : uploadedField(device, "field upload", MemoryUse::Upload),
        field(device, "field to draw"),
        uploadedValues(device, "numbers upload", MemoryUse::Upload),
        values(device, "numbers to draw"),
        uploadedIndex(device, "index upload", MemoryUse::Upload),
        index(device, "index of leaves"),
        pixels(device, "pixels"),
        picture(device, "picture for the host", MemoryUse::ReadBack) {
    for (DeviceBuffer* buffer : {&uploadedField, &field}) buffer->resize<float>(samples);
    if (hasValues)
      for (DeviceBuffer* buffer : {&uploadedValues, &values}) buffer->resize<float>(samples);
    if (!leafIndex.empty()) {
      uploadedIndex.fill(leafIndex);
      index.resize<uint32_t>(leafIndex.size());
    }
    for (DeviceBuffer* buffer : {&pixels, &picture}) buffer->resize<uint32_t>(pixelCount);
  }
  DeviceBuffer uploadedField, field, uploadedValues, values, uploadedIndex, index, pixels, picture;
};

void take(std::span<const uint32_t> pixels, Picture& picture) {
  uint8_t* rgb = picture.rgb.data();
  for (const uint32_t pixel : pixels)
    for (const int shift : {0, 8, 16}) *rgb++ = static_cast<uint8_t>(pixel >> shift);
}

}  // namespace

void drawScene(Device& device, const DrawnScene& scene, Progress& progress, Picture& picture) {
  const DrawnField& field = scene.shape.field();
  const LeafTree* tree = field.tree();
  RenderFieldStage stage(device);
  stage.checkScene(scene);
  const ShownNumbers* shown = scene.numbers ? &*scene.numbers : nullptr;
  const double scale = 1.0 / field.grid().spacing;
  Buffers buffers(device, std::max(field.sampleCount(), size_t{1}), shown,
                  tree ? field.leafIndex(scale) : std::vector<uint32_t>(), picture.rgb.size() / 3);
  fillSamples(field.field().distance, scale, buffers.uploadedField.mapped<float>());
  if (shown)
    fillSamples(shown->numbers(), shown->isDifference() ? scale : 1.0,
                buffers.uploadedValues.mapped<float>());
  CommandBuffer buffer(device);
  const auto run = [&](const auto& record) {
    Commands commands = buffer.begin();
    record(commands);
    buffer.submitAndWait();
  };
  run([&](Commands& commands) {
    stage.recordScene(commands, scene, picture.width, picture.height, {}, tree ? buffers.index.address() : 0);
    commands.copy(buffers.uploadedField, buffers.field, buffers.field.bytes());
    if (tree) commands.copy(buffers.uploadedIndex, buffers.index, buffers.index.bytes());
    if (shown) commands.copy(buffers.uploadedValues, buffers.values, buffers.values.bytes());
  });
  const RenderFieldStage::Samples samples{.address = buffers.field.address(),
                                          .values = shown ? buffers.values.address() : 0};
  Bands bands;
  for (int first = 0; first < picture.height;) {
    const int rows = std::min(bands.rows(), picture.height - first);
    const auto draw = [&](Commands& commands) {
      stage.recordRows(commands, samples, {.colour = buffers.pixels.address()}, first, rows);
    };
    bands.time([&] { run(draw); });
    first += rows;
    progress.report(double(first) / picture.height);
  }
  run([&](Commands& commands) { commands.copy(buffers.pixels, buffers.picture, buffers.picture.bytes()); });
  take(buffers.picture.mapped<uint32_t>(), picture);
}

}  // namespace raymap::vulkan
