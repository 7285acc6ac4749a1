// Ours, after Krayer & Müller 2019, §3.5: the field shows which way the faces point.

#include "vulkan/stages/orientation.h"

#include "base/ceil_div.h"
#include "shaders/orientation_misfit_spv.h"
#include "shaders/orientation_parity_spv.h"
#include "shaders/orientation_sides_spv.h"

namespace raymap::vulkan {

namespace {
constexpr uint64_t kSamplesOfGroup = uint64_t{kMisfitGroup} * kMisfitSamples;
}  // namespace

OrientationStage::OrientationStage(Device& device)
    : misfitOf_(device, shaders::kOrientationMisfit, kMisfitGroup),
      parityOf_(device, shaders::kOrientationParity, kGroup),
      sidesOf_(device, shaders::kOrientationSides, kGroup),
      sums_(device, "misfits"),
      hostSums_(device, "misfits for the host", MemoryUse::ReadBack),
      sides_(device, "field beside the faces"),
      hostSides_(device, "field beside the faces for the host", MemoryUse::ReadBack) {}

void OrientationStage::reserve(const glm::ivec3& dims, uint32_t triangleCount) {
  samples_ = uint64_t(dims.x) * uint64_t(dims.y) * uint64_t(dims.z);
  triangleCount_ = triangleCount;
  for (DeviceBuffer* sums : {&sums_, &hostSums_})
    sums->resize<float>(kMisfitNumbers * ceilDiv(samples_, kSamplesOfGroup));
  for (DeviceBuffer* sides : {&sides_, &hostSides_}) sides->resize<float>(triangleCount);
}

OrientationPush OrientationStage::push(const Fields& fields, float farSides, SideMeasure measure) const {
  return {.rays = {fields.rays.axes[0], fields.rays.axes[1], fields.rays.axes[2]},
          .field = fields.field,
          .vertices = fields.mesh.vertices,
          .triangles = fields.mesh.triangles,
          .sides = sides_.address(),
          .misfit = sums_.address(),
          .dims = glm::uvec3(fields.rays.dims),
          .triangleCount = triangleCount_,
          .farSides = farSides,
          .threshold = static_cast<float>(fields.threshold),
          .isWholeness = measure == SideMeasure::Wholeness ? 1u : 0u};
}

void OrientationStage::recordMisfit(Commands& commands, const Fields& fields) {
  commands.dispatch(misfitOf_, push(fields), sums_.bytes() / (kMisfitNumbers * sizeof(float)) * kMisfitGroup);
  commands.copy(sums_, hostSums_, hostSums_.bytes());
}

void OrientationStage::recordParity(Commands& commands, const Fields& fields) {
  commands.dispatch(parityOf_, push(fields), samples_);
}

void OrientationStage::recordSides(Commands& commands, const Fields& fields, float farSides,
                                   SideMeasure measure) {
  commands.dispatch(sidesOf_, push(fields, farSides, measure), triangleCount_);
  commands.copy(sides_, hostSides_, hostSides_.bytes());
}

double OrientationStage::misfit() const {
  const std::span<const float> sums = hostSums_.mapped<const float>();
  double squares = 0.0, jumps = 0.0;
  for (size_t group = 0; group < sums.size(); group += kMisfitNumbers) {
    squares += sums[group];
    jumps += sums[group + 1];
  }
  return jumps > 0.0 ? squares / jumps : 0.0;
}

bool OrientationStage::contradictsParity() const {
  const std::span<const float> sums = hostSums_.mapped<const float>();
  for (size_t group = 0; group < sums.size(); group += kMisfitNumbers)
    if (sums[group + 2] > 0.0f) return true;
  return false;
}

}  // namespace raymap::vulkan
