// A picture of a field, sphere traced by the CPU or by a device.

#include <raymap/generate.h>
#include <raymap/render.h>

#include <atomic>

#include "cpu/parallel.h"
#include "devices.h"
#include "progress.h"
#include "scene.h"
#include "shade.h"
#ifdef RAYMAP_VULKAN
#include "vulkan/draw_scene.h"
#endif

namespace raymap {

namespace {

void drawOnCpu(const Scene& scene, Progress& progress, Picture& picture) {
  std::atomic<int> rows{0};
  parallelFor(size_t(picture.height), 1, [&](size_t y, size_t) {
    for (int x = 0; x < picture.width; ++x) setPixel(picture, x, int(y), pixelColour(scene, x, int(y)));
    progress.report(double(++rows) / picture.height);
  });
}

#ifdef RAYMAP_VULKAN
void drawOnGpu(size_t index, const Scene& scene, Progress& progress, Picture& picture) {
  vulkan::drawScene(index, scene, progress, picture);
}
#else
void drawOnGpu(size_t, const Scene&, Progress&, Picture&) {}
#endif

}  // namespace

Picture renderField(const Field& field, const RenderOptions& options) {
  validateField(field);
  Picture picture = makePicture(options.width, options.height);
  Options run;
  if (options.progress) run.progress = [&](std::string_view, double done) { return options.progress(done); };
  Stats stats;
  Progress progress(run, stats);
  const auto draw = [&] {
    const Scene scene(field, options);
    runOnDevice(
        options.device, options.warn, [&](size_t index) { drawOnGpu(index, scene, progress, picture); },
        [&] { drawOnCpu(scene, progress, picture); });
  };
  progress.stage("render", [&] { withThreads(options.threads, draw); });
  return picture;
}

}  // namespace raymap
