// Krayer & Müller 2019, §3.3, Algorithms 1 and 2.
//
// Paper: one line per invocation, in shared memory, so that fewer lines are in flight as lines grow. Here:
// along x a subgroup takes the nearest cell on each side (distance_transform_rows.comp). Along y and z no
// envelope is built: a sample's best site lies between those of the samples on both sides, so the middle one
// halves the search (docs/dev/decisions/distance_transform.md). Passes do not exchange values, only the
// nearest cell's place; the value follows from it.

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

constexpr uint32_t kInvocations = 256;
constexpr uint32_t kFewLines = 8;  // Fewer lines would make memory access slower.
constexpr uint32_t kMostLines =
    32;  // More lines would not make it faster, and would be worse for small grids.
constexpr uint32_t kMostCells = 4352;
constexpr uint32_t kCellBytes = 8, kMarkBytes = 4;

/// Returns the marks for the cells that fit into a group's shared memory: one for each run, and as many more
/// as make a power of two.
uint32_t marksOf(const DeviceLimits& limits) {
  const uint32_t runs = ceilDiv(limits.sharedMemory, kRunCells * kCellBytes + kMarkBytes);
  static_assert(std::bit_ceil(kMostCells / kRunCells) <=
                2 * kInvocations);  // One mark per invocation and level.
  return std::bit_ceil(std::min(kMostCells / kRunCells, runs));
}

uint32_t cellsOf(const DeviceLimits& limits) {
  return std::min(kMostCells, (limits.sharedMemory - kMarkBytes * marksOf(limits)) / kCellBytes);
}

}  // namespace

DistanceTransformStage::DistanceTransformStage(Device& device, ScratchMemory* scratch)
    : cells_(cellsOf(device.limits())),
      subgroupSize_(device.limits().maxSubgroupSize),
      alongX_(device, shaders::kDistanceTransformRows, std::max(kGroup, device.limits().maxSubgroupSize)),
      alongY_(device, shaders::kDistanceTransform, kInvocations, {1, cells_, marksOf(device.limits())}),
      alongZ_(device, shaders::kDistanceTransform, kInvocations, {2, cells_, marksOf(device.limits())}),
      nearest_(device, "nearest cells", scratch),
      scratch_(device, "nearest cells, pass before", scratch) {}

void DistanceTransformStage::reserve(const glm::ivec3& dims) {
  const auto longest = static_cast<uint32_t>(std::max({dims.x, dims.y, dims.z}));
  if (longest > cells_)
    throw Error(ErrorCode::Unsupported, "the grid has " + std::to_string(longest) +
                                            " samples along an axis, the device can transform at most " +
                                            std::to_string(cells_) + "; use a lower resolution or the CPU");
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
  return {.values = squared, .from = from, .to = to, .dims = glm::uvec3(dims_), .empty = emptyCell(dims_)};
}

void DistanceTransformStage::pass(Commands& commands, Kernel<Push>& kernel, int axis, VkDeviceAddress squared,
                                  VkDeviceAddress from, VkDeviceAddress to) {
  const glm::uvec3 dims(dims_);
  const auto length = static_cast<uint32_t>(dims_[axis]);
  Push push = pushOf(squared, from, to);
  push.runs = ceilDiv(length, kRunCells);
  push.lines =
      std::bit_floor(std::min(std::clamp(kInvocations / push.runs, kFewLines, kMostLines), cells_ / length));
  const uint64_t groups = ceilDiv(dims.x, push.lines) * (axis == 1 ? dims.z : dims.y);
  commands.dispatch(kernel, push, groups * kInvocations);
}

}  // namespace raymap::vulkan
