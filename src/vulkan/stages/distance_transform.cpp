// Krayer & Müller 2019, §3.3, Algorithms 1 and 2.
//
// Paper: one line per invocation, in shared memory, so that fewer lines are in flight as lines grow. Here:
// along x a subgroup takes the nearest cell on each side (distance_transform_rows.comp). Along y and z
// each invocation computes the lower envelope of one segment of a line. Then neighbouring envelopes are
// merged, pair by pair. A group therefore has the same number of invocations at every resolution, and as many
// lines as fit into its shared memory. Passes do not exchange values, only the nearest cell's place; the
// value follows from it.

#include "vulkan/stages/distance_transform.h"

#include <raymap/error.h>

#include <algorithm>
#include <bit>
#include <string>

#include "base/ceil_div.h"
#include "method/cell_lattice.h"
#include "shaders/distance_transform_rows_spv.h"
#include "shaders/distance_transform_spv.h"

namespace raymap::vulkan {

namespace {

constexpr uint32_t kBytesPerInvocation = kSegmentCells * 8 + 4;

/// Returns 256 invocations, or as many as the shared memory allows.
uint32_t groupSizeOf(const DeviceLimits& limits) {
  return std::min(256U, limits.sharedMemory / kBytesPerInvocation / 32 * 32);
}

uint32_t segmentsOf(int length) {
  return static_cast<uint32_t>(ceilDiv(static_cast<uint32_t>(length), kSegmentCells));
}

}  // namespace

DistanceTransformStage::DistanceTransformStage(Device& device, ScratchMemory* scratch)
    : groupSize_(groupSizeOf(device.limits())),
      subgroupSize_(device.limits().maxSubgroupSize),
      alongX_(device, shaders::kDistanceTransformRows, std::max(kGroup, device.limits().maxSubgroupSize)),
      alongY_(device, shaders::kDistanceTransform, groupSize_, {1, groupSize_ * kSegmentCells, groupSize_}),
      alongZ_(device, shaders::kDistanceTransform, groupSize_, {2, groupSize_ * kSegmentCells, groupSize_}),
      nearest_(device, "nearest cells", scratch),
      scratch_(device, "nearest cells, pass before", scratch) {}

void DistanceTransformStage::reserve(const glm::ivec3& dims) {
  const auto longest = static_cast<uint32_t>(std::max({dims.x, dims.y, dims.z}));
  if (const uint32_t most = groupSize_ * kSegmentCells; longest > most)
    throw Error(ErrorCode::Unsupported, "the grid has " + std::to_string(longest) +
                                            " samples along an axis, the device can transform at most " +
                                            std::to_string(most) + "; use a lower resolution or the CPU");
  const uint64_t count = uint64_t(dims.x) * uint64_t(dims.y) * uint64_t(dims.z);
  nearest_.resize<uint32_t>(count);
  scratch_.resize<uint32_t>(count);
  dims_ = dims;
}

void DistanceTransformStage::record(Commands& commands, VkDeviceAddress squared) {
  const uint64_t rows = uint64_t(dims_.y) * uint64_t(dims_.z);
  commands.dispatch(alongX_, pushOf(squared, 0, nearest_.address()), rows * subgroupSize_);
  pass(commands, alongY_, 1, squared, nearest_.address(), scratch_.address());
  pass(commands, alongZ_, 2, squared, scratch_.address(), nearest_.address());
}

DistanceTransformPush DistanceTransformStage::pushOf(VkDeviceAddress squared, VkDeviceAddress from,
                                                     VkDeviceAddress to) const {
  const glm::uvec3 dims(dims_);
  return {.values = squared,
          .from = from,
          .to = to,
          .nx = dims.x,
          .ny = dims.y,
          .nz = dims.z,
          .empty = emptyCell(dims_)};
}

void DistanceTransformStage::pass(Commands& commands, Kernel<Push>& kernel, int axis, VkDeviceAddress squared,
                                  VkDeviceAddress from, VkDeviceAddress to) {
  constexpr uint32_t kMostLines = 64;  // More lines would not make memory access faster, and would be worse
                                       // for small grids.
  const glm::uvec3 dims(dims_);
  const uint32_t segments = segmentsOf(dims_[axis]);
  const uint32_t fit = std::min(kMostLines, groupSize_ / segments);
  Push push = pushOf(squared, from, to);
  push.lines = std::bit_floor(fit);
  push.segments = segments;
  const uint64_t groups = ceilDiv(dims.x, push.lines) * (axis == 1 ? dims.z : dims.y);
  commands.dispatch(kernel, push, groups * groupSize_);
}

}  // namespace raymap::vulkan
