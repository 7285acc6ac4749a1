#include "draw_scene.h"

#include <algorithm>
#include <chrono>

#include "command_buffer.h"
#include "render_field.h"

namespace raymap::vulkan {

namespace {

/// Rows to draw at once: so few that somebody who cancels does not wait, nor the system for the device; so
/// many that it has work.
class Bands {
 public:
  int rows() const { return rows_; }
  /// Calls `draw` and learns from the time it takes.
  template <class Draw>
  void time(Draw&& draw) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    draw();
    const auto took = Clock::now() - start;
    if (took < std::chrono::milliseconds(50)) rows_ *= 2;
    if (took > std::chrono::milliseconds(200)) rows_ = std::max(rows_ / 2, kLeast);
  }

 private:
  static constexpr int kLeast = kRenderTile;
  int rows_ = 8 * kLeast;
};

}  // namespace

void drawScene(Device& device, const Scene& scene, Progress& progress, Picture& picture) {
  RenderField stage(device);
  stage.reserve(scene, picture.width, picture.height);
  CommandBuffer buffer(device);
  const auto run = [&](const auto& record) {
    Commands commands = buffer.begin();
    record(commands);
    buffer.submitAndWait();
  };
  run([&](Commands& commands) { stage.recordScene(commands); });
  Bands bands;
  for (int first = 0; first < picture.height;) {
    const int rows = std::min(bands.rows(), picture.height - first);
    bands.time([&] { run([&](Commands& commands) { stage.recordRows(commands, first, rows); }); });
    first += rows;
    progress.report(double(first) / picture.height);
  }
  run([&](Commands& commands) { stage.recordPicture(commands); });
  stage.take(picture);
}

void drawScene(size_t index, const Scene& scene, Progress& progress, Picture& picture) {
  Device device({.index = index});
  drawScene(device, scene, progress, picture);
}

}  // namespace raymap::vulkan
