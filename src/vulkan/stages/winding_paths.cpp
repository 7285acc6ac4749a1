// Krayer & Müller 2019, §3.5, Eq. 9-11: curves by way of other points. If all rays agree, the device skips
// the work without asking the host.

#include "vulkan/stages/winding_paths.h"

#include <algorithm>

#include "method/winding_paths_offsets.h"
#include "shaders/winding_paths_spv.h"

namespace raymap::vulkan {

static_assert(kPointsPerStep <= kPointsPerDispatch);

WindingPathsStage::WindingPathsStage(Device& device, ScratchMemory* scratch)
    : gate_(device, "winding paths dispatch"),
      kernel_(device, shaders::kWindingPaths, kWindingPathsGroup),
      next_(device, "winding of the next step", scratch) {
  gate_.reserve(1);
}

void WindingPathsStage::reserve(const glm::ivec3& dims) {
  const uint64_t samples = uint64_t(dims.x) * uint64_t(dims.y) * uint64_t(dims.z);
  next_.resize<float>(samples);
  gate_.plan(0, (samples + kWindingPathsGroup - 1) / kWindingPathsGroup);
  dims_ = dims;
}

void WindingPathsStage::recordAverage(Commands& commands, const WindingFields& fields,
                                      const Options& options) {
  gate_.record(commands, fields.doubtful);
  WindingPathsPush some = push(fields);
  some.sumScale = some.pointScale = kRays;
  int64_t pass = 0;
  do {  // Runs once even for no passes: six times the average, divided by six, is the CPU's average.
    const int64_t end = std::min<int64_t>(pass + kPointsPerDispatch, options.passes);
    if (end == options.passes) some.factor = 1.0 / double(kRays * (1.0f + kPathsPerPoint * float(end)));
    add(commands, some, options, pass, end);
    some.sums = some.result;
    some.sumScale = 1.0f;
    pass = end;
  } while (pass < options.passes);
  some.factor = 1.0;
  some.result = fields.winding;
  add(commands, some, options, 0, 0);
}

void WindingPathsStage::recordEvolution(Commands& commands, const WindingFields& fields,
                                        const Options& options) {
  gate_.record(commands, fields.doubtful);
  WindingPathsPush step = push(fields);
  // Eq. 10-11. Paper: counts c and n. Here: w = c / n, as on the CPU.
  step.factor = 1.0 / double(1 + kPathsPerPoint * kPointsPerStep);
  for (int64_t first = 0; first < int64_t{options.passes} * kPointsPerStep; first += kPointsPerStep) {
    add(commands, step, options, first, first + kPointsPerStep);
    std::swap(step.values, step.result);
    step.sums = step.values;
  }
  if (step.values == fields.winding) return;
  step.factor = 1.0;
  add(commands, step, options, 0, 0);
}

void WindingPathsStage::add(Commands& commands, WindingPathsPush push, const Options& options, int64_t first,
                            int64_t end) {
  push.pointCount = static_cast<uint32_t>(end - first);
  for (int64_t pass = first; pass < end; ++pass) {
    const glm::ivec3 offset = offsetOf(options, pass, dims_);
    for (int c = 0; c < 3; ++c) push.offsets[3 * (pass - first) + c] = offset[c];
  }
  gate_.dispatch(commands, kernel_, push, 0);
}

WindingPathsPush WindingPathsStage::push(const WindingFields& fields) const {
  return {.rays = {fields.rays[0], fields.rays[1], fields.rays[2]},
          .values = fields.winding,
          .sums = fields.winding,
          .result = next_.address(),
          .factor = 1.0,
          .sumScale = 1.0f,
          .pointScale = 1.0f,
          .dims = {uint32_t(dims_.x), uint32_t(dims_.y), uint32_t(dims_.z)}};
}

}  // namespace raymap::vulkan
