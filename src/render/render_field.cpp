// Picture of a field, sphere traced on the CPU or a GPU.

#include <raymap/generate.h>
#include <raymap/render.h>

#include <atomic>

#include "api/devices.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "cpu/render/shade.h"
#include "render/render_scene.h"

namespace raymap {

namespace {

void drawOnCpu(const Scene& scene, Progress& progress, Picture& picture) {
  std::atomic<int> rows{0};
  parallelFor(size_t(picture.height), 1, [&](size_t y, size_t) {
    for (int x = 0; x < picture.width; ++x) setPixel(picture, x, int(y), cpu::pixelColour(scene, x, int(y)));
    progress.report(double(++rows) / picture.height);
  });
}

}  // namespace

Picture renderScene(const Scene& scene, const RenderOptions& options, const MachineOptions& machine) {
  Picture picture = makePicture(options.width, options.height);
  Progress progress(machine.progress);
  const auto draw = [&] {
    const auto onGpu = [&](GpuDevice& gpu, size_t) { gpu.draw(scene, progress, picture); };
    if (!ChosenDevice().run(machine, onGpu)) drawOnCpu(scene, progress, picture);
  };
  progress.stage("render", [&] { withThreads(machine.threads, draw); });
  return picture;
}

Picture renderField(const Field& field, const RenderOptions& options, const MachineOptions& machine) {
  validateField(field);
  checkPictureSize(options.width, options.height);
  Picture picture;
  withThreads(machine.threads, [&] { picture = renderScene(Scene(field, options), options, machine); });
  return picture;
}

}  // namespace raymap
