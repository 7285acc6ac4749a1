// Picture of a field, sphere traced on the CPU or a GPU.

#include <raymap/error.h>
#include <raymap/generate.h>
#include <raymap/names.h>
#include <raymap/render.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

#include "api/devices.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/require.h"
#include "base/text.h"
#include "cpu/render/shade.h"
#include "field/field_sampler.h"
#include "render/render_scene.h"
#include "render/resample.h"

namespace raymap {

namespace {

void drawOnCpu(const DrawnScene& scene, Progress& progress, Picture& picture) {
  std::atomic<int> rows{0};
  parallelFor(size_t(picture.height), 1, [&](size_t y, size_t) {
    for (int x = 0; x < picture.width; ++x) setPixel(picture, x, int(y), cpu::pixelColour(scene, x, int(y)));
    progress.report(double(++rows) / picture.height);
  });
}

}  // namespace

Picture renderScene(const DrawnScene& scene, const RenderOptions& options, const MachineOptions& machine) {
  Picture picture = makePicture(options.width, options.height);
  Progress progress(machine.progress);
  const auto draw = [&] {
    const auto onGpu = [&](GpuDevice& gpu, size_t) { gpu.draw(scene, progress, picture); };
    if (!ChosenDevice().run(machine, onGpu)) drawOnCpu(scene, progress, picture);
  };
  progress.stage("render", [&] { withThreads(machine.threads, draw); });
  return picture;
}

void checkNumbers(const Field& field, FieldArray array) {
  validateArray(field, array);
  const Buffer<float>& numbers = numbersOf(field, array);
  const auto* odd = std::ranges::find_if_not(numbers, [](float number) { return std::isfinite(number); });
  if (odd != numbers.end())
    throw Error(ErrorCode::Input, "the array '" + std::string(name(array)) + "' of the field is " +
                                      numberText(*odd) + " at index " +
                                      std::to_string(odd - numbers.begin()) +
                                      ": its colours need finite numbers; leave the array out");
}

Picture renderField(const Field& field, const RenderOptions& options, const MachineOptions& machine) {
  validateField(field);
  checkPictureSize(options.width, options.height);
  if (options.array == FieldArray::Triangle)
    throw Error(ErrorCode::Usage, "a surface has no colours of triangles; draw a slice of them");
  if (options.other && options.array != FieldArray::Distance)
    throw Error(ErrorCode::Usage, "a picture shows the difference of two fields or the array '" +
                                      std::string(name(options.array)) + "', not both");
  if (options.array != FieldArray::Distance) checkNumbers(field, options.array);
  if (options.other) checkNumbers(*options.other, FieldArray::Distance);
  Picture picture;
  withThreads(machine.threads, [&] {
    RenderOptions alike = options;
    Field other;
    if (options.other && options.other->grid != field.grid) {
      other = resampled(*options.other, field.grid);
      alike.other = &other;
    }
    picture = renderScene(DrawnScene(field, alike), alike, machine);
  });
  return picture;
}

Picture renderField(const SparseField& band, const RenderOptions& options, const MachineOptions& machine) {
  validate(band);
  checkPictureSize(options.width, options.height);
  require(options.array == FieldArray::Distance && !options.other,
          "a picture of a narrow band shows its distances alone; draw a slice of another array, and leave "
          "out the second field");
  MachineOptions onCpu = machine;
  onCpu.device = "cpu";
  Picture picture;
  withThreads(machine.threads, [&] { picture = renderScene(DrawnScene(band, options), options, onCpu); });
  return picture;
}

}  // namespace raymap
