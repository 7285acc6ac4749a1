// Krayer & Müller 2019, §3.5, Eq. 9-11: curves by way of other points. If all rays agree, the device skips
// the work without asking the host.

#include "vulkan/stages/winding_paths.h"

#include <algorithm>
#include <array>

#include "base/ceil_div.h"
#include "method/winding_paths_offsets.h"
#include "shaders/winding_paths_spv.h"

namespace raymap::vulkan {

WindingPathsStage::WindingPathsStage(Device& device, ScratchMemory* scratch)
    : gate_(device, "winding paths dispatch"),
      zeroOutside_(device, shaders::kWindingPaths, kWindingPathsGroup, {0}),
      raysOutside_(device, shaders::kWindingPaths, kWindingPathsGroup, {1}),
      next_(device, "winding of the next step", scratch) {}

void WindingPathsStage::reserve(const glm::ivec3& dims) {
  const uint64_t samples = uint64_t(dims.x) * uint64_t(dims.y) * uint64_t(dims.z);
  next_.resize<float>(samples);
  gate_.plan(std::array{ceilDiv(samples, kWindingPathsGroup)}, kMostGroups);
  dims_ = dims;
}

void WindingPathsStage::recordAverage(Commands& commands, const WindingFields& fields,
                                      const FieldOptions& options) {
  gate_.record(commands, fields.doubtful);
  const int64_t points = int64_t{options.passes} * pointsPerPass(options);
  WindingPathsPush mean = push(fields);
  mean.sumScale = mean.pointScale = kRays;
  mean.divisor = kRays * (1.0f + kPathsPerPoint * float(points));
  add(commands, mean, options, 0,
      points);  // No points: six times the average, divided by six, as on the CPU.
  copy(commands, next_.address(), fields);
}

void WindingPathsStage::recordEvolution(Commands& commands, const WindingFields& fields,
                                        const FieldOptions& options) {
  gate_.record(commands, fields.doubtful);
  const int64_t points = pointsPerPass(options);
  WindingPathsPush step = push(fields);
  // Eq. 10-11. Paper: counts c and n. Here: w = c / n, as on the CPU.
  step.divisor = static_cast<float>(1 + kPathsPerPoint * points);
  for (int64_t first = 0; first < options.passes * points; first += points) {
    add(commands, step, options, first, first + points);
    std::swap(step.values, step.result);
    step.sums = step.values;
  }
  if (step.values != fields.winding) copy(commands, step.values, fields);
}

void WindingPathsStage::add(Commands& commands, WindingPathsPush push, const FieldOptions& options,
                            int64_t first, int64_t end) {
  Kernel<WindingPathsPush>& kernel = options.sampling == Sampling::Paper ? raysOutside_ : zeroOutside_;
  const float divisor = push.divisor;
  const int64_t all = std::max<int64_t>(int64_t{options.passes} * pointsPerPass(options), 1);
  do {
    push.pointCount = static_cast<uint32_t>(std::min<int64_t>(end - first, kPointsPerDispatch));
    for (uint32_t point = 0; point < push.pointCount; ++point) {
      const glm::ivec3 offset = offsetOf(options, first + point, dims_);
      for (int c = 0; c < 3; ++c) push.offsets[3 * point + c] = offset[c];
    }
    first += push.pointCount;
    push.divisor = first < end ? 1.0f : divisor;
    gate_.dispatch(commands, kernel, push, 0);
    commands.report(double(first) / double(all));
    push.sums = push.result;
    push.sumScale = 1.0f;
  } while (first < end);
}

void WindingPathsStage::copy(Commands& commands, VkDeviceAddress from, const WindingFields& fields) {
  WindingPathsPush push = this->push(fields);
  push.sums = from;
  push.result = fields.winding;
  gate_.dispatch(commands, zeroOutside_, push, 0);
}

WindingPathsPush WindingPathsStage::push(const WindingFields& fields) const {
  return {.rays = {fields.rays[0], fields.rays[1], fields.rays[2]},
          .values = fields.winding,
          .sums = fields.winding,
          .result = next_.address(),
          .divisor = 1.0f,
          .sumScale = 1.0f,
          .pointScale = 1.0f,
          .dims = glm::uvec3(dims_)};
}

}  // namespace raymap::vulkan
