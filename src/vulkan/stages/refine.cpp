// Krayer & Müller 2019, §3.3, end.
//
// Paper: one invocation per sample. Here: the same, but a group per sample with many triangles. A single
// invocation would take too long over crowded cells (fine meshes on coarse grids). Samples share what of a
// distance depends on the triangle alone: its frame, which is found once.

#include "vulkan/stages/refine.h"

#include <algorithm>

#include "base/ceil_div.h"
#include "shaders/refine_crowded_spv.h"
#include "shaders/refine_frames_spv.h"
#include "shaders/refine_spv.h"
#include "vulkan/stages/surface_tree_push.h"

namespace raymap::vulkan {

namespace {
/// Dispatches over the crowded samples, at most: each costs time even if it is empty. In grids of more than
/// 2^18 samples one may therefore have more than kMostGroups groups.
constexpr uint32_t kMostCrowdedDispatches = 8;
}  // namespace

RefineStage::RefineStage(Device& device, ScratchMemory* scratch)
    : findFrames_(device, shaders::kRefineFrames, kRefineGroup),
      alone_(device, shaders::kRefine, kRefineGroup),
      crowded_(device, shaders::kRefineCrowded, kRefineGroup),
      levels_(device),
      arguments_(device, "refine arguments"),
      frames_(device, "frames of triangles", scratch),
      crowdedCount_(device, "crowded samples' count") {}

void RefineStage::reserve(const glm::ivec3& dims, uint32_t triangles, std::span<const CellLevelData> levels) {
  dims_ = dims;
  for (auto* kernel : {&alone_, &crowded_}) kernel->choose(levels.size() == 1);
  levels_.reserve(levels);
  frames_.resize<glm::vec4>(uint64_t{triangles} * kFrameVectors);
  crowdedCount_.resize<uint32_t>(1);
  const uint32_t samples = dims_.x * dims_.y * dims_.z;
  arguments_.reserve(
      {.most = samples,
       .mostGroups = std::max(kMostGroups, static_cast<uint32_t>(ceilDiv(samples, kMostCrowdedDispatches)))});
}

void RefineStage::record(Commands& commands, const DeviceMesh& mesh, const Fields& fields, int reach) {
  const uint32_t samples = dims_.x * dims_.y * dims_.z;
  const RefinePush push{.levels = levels_.address(),
                        .vertices = mesh.vertices,
                        .triangles = mesh.triangles,
                        .frames = frames_.address(),
                        .distance = fields.distance,
                        .closest = fields.triangle,
                        .crowded = fields.scratch,
                        .crowdedCount = crowdedCount_.address(),
                        .dims = dims_,
                        .levelCount = levels_.count(),
                        .reach = static_cast<uint32_t>(reach),
                        // Many samples keep the device busy even if some take long; few do not.
                        .mostAlone = std::clamp(samples >> 8, 16U, 512U),
                        .triangleCount = mesh.triangleCount};
  commands.concurrent([&] {
    levels_.record(commands);
    commands.fill(crowdedCount_, 0);
    commands.dispatch(findFrames_, push, mesh.triangleCount);
  });
  commands.dispatch(*alone_, push, samples);
  arguments_.record(commands, crowdedCount_.address());
  arguments_.dispatch(commands, *crowded_, push);
}

}  // namespace raymap::vulkan
