// Krayer & Müller 2019, §3.5, Eq. 3-8.

#include "vulkan/stages/ray_map.h"

#include <algorithm>

#include "shaders/ray_map_across_spv.h"
#include "shaders/ray_map_along_spv.h"

namespace raymap::vulkan {

namespace {
constexpr uint32_t kFewEdges = 16;  // Most edges of a line that one invocation sums; a subgroup would idle.
}

RayMapStage::RayMapStage(Device& device)
    : largestSubgroup_(device.limits().maxSubgroupSize),
      across_(device, shaders::kRayMapAcross, kRayMapGroup),
      along_(device, shaders::kRayMapAlong, kRayMapGroup) {}

void RayMapStage::record(Commands& commands, const LatticeLines& lines) {
  // Very long lines are summed in pieces, the last ones first. Nearly all lines have one piece.
  const int longest = std::max({lines.dims.x, lines.dims.y, lines.dims.z});
  for (uint64_t done = 0; done <= static_cast<uint64_t>(longest); done += kRayMapPiece)
    commands.concurrent([&] {
      for (int axis = 0; axis < 3; ++axis) recordAxis(commands, lines, axis, done);
    });
}

void RayMapStage::recordAxis(Commands& commands, const LatticeLines& lines, int axis, uint64_t done) {
  const auto length = [&](int a) { return static_cast<uint32_t>(lines.dims[a]); };
  RayMapPush push{.edges = lines.axes[static_cast<size_t>(axis)],
                  .lineCount = 1,
                  .edgesOfLine = length(axis) + 1,
                  .stride = 1};
  if (done >= push.edgesOfLine) return;
  push.end = push.edgesOfLine - static_cast<uint32_t>(done);
  for (int a = 0; a < 3; ++a) {
    if (a < axis) push.stride *= length(a);
    if (a != axis) push.lineCount *= length(a);
  }
  if (push.stride == 1 && push.edgesOfLine > kFewEdges)
    commands.dispatch(along_, push, uint64_t{push.lineCount} * largestSubgroup_);
  else
    commands.dispatch(across_, push, push.lineCount);
}

}  // namespace raymap::vulkan
