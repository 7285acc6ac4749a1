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

void checkOptions(const RenderOptions& options) {
  checkPictureSize(options.width, options.height);
  require(options.array != FieldArray::Triangle,
          "a surface has no colours of triangles; draw a slice of them");
  require(!options.other || options.array == FieldArray::Distance,
          "a picture shows the difference of two fields or the array '" + std::string(name(options.array)) +
              "', not both");
}

[[noreturn]] void refuseNumber(FieldArray array, const char* of, float number, const std::string& where) {
  throw Error(ErrorCode::Input, "the array '" + std::string(name(array)) + "' of the " + of + " is " +
                                    numberText(number) + " at " + where +
                                    ": its colours need finite numbers; leave the array out");
}

/// Returns the sample of a place in a narrow band's arrays.
glm::ivec3 sampleOf(const Field& band, size_t place) {
  constexpr int kSide = NarrowBand::kLeafSide;
  const int within = int(place % NarrowBand::kLeafSamples);
  return band.narrow->leaves[place / NarrowBand::kLeafSamples] +
         glm::ivec3(within % kSide, within / kSide % kSide, within / (kSide * kSide));
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
  for (size_t place = 0; place < numbers.size(); ++place) {
    if (std::isfinite(numbers[place])) continue;
    if (!field.narrow) refuseNumber(array, "field", numbers[place], "index " + std::to_string(place));
    const glm::ivec3 sample = sampleOf(field, place);
    if (glm::any(glm::greaterThanEqual(sample, field.grid.dims))) continue;
    refuseNumber(array, "narrow band", numbers[place],
                 "sample (" + std::to_string(sample.x) + ", " + std::to_string(sample.y) + ", " +
                     std::to_string(sample.z) + ")");
  }
}

Picture renderField(const Field& field, const RenderOptions& options, const MachineOptions& machine) {
  validateArray(field, FieldArray::Distance);
  checkOptions(options);
  if (options.array != FieldArray::Distance) checkNumbers(field, options.array);
  if (options.other) checkNumbers(*options.other, FieldArray::Distance);
  RenderOptions shown = options;
  MachineOptions chosen = machine;
  if (options.other && field.narrow) {
    require(!machine.device.starts_with("vulkan"),
            "the difference from a narrow band is drawn on the CPU; choose no other device");
    chosen.device = "cpu";
  }
  Picture picture;
  withThreads(machine.threads, [&] {
    Field other;
    if (options.other && !field.narrow && !options.other->narrow && options.other->grid != field.grid) {
      other = resampled(*options.other, field.grid, machine);
      shown.other = &other;
    }
    picture = renderScene(DrawnScene(field, shown), shown, chosen);
  });
  return picture;
}

}  // namespace raymap
