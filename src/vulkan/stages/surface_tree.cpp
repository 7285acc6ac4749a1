// Ours (the paper's future work names a hierarchy): the tree for exact_distance.

#include "vulkan/stages/surface_tree.h"

#include <algorithm>
#include <stdexcept>

#include "base/ceil_div.h"
#include "shaders/surface_tree_bounds_spv.h"
#include "shaders/surface_tree_keys_spv.h"
#include "shaders/surface_tree_leaves_spv.h"
#include "shaders/surface_tree_level_spv.h"
#include "shaders/surface_tree_order_spv.h"

namespace raymap::vulkan {

namespace {

constexpr uint32_t kRun = 512;         // Triangles of the curve that one group reorders.
constexpr uint32_t kLevelGroup = 256;  // Most nodes of a level that one group does, with all above.
constexpr uint32_t kMostTriangles = uint32_t{1} << 29;

/// Returns the bits of the keys by which triangles are sorted. Runs of the curve are ordered anew, so that
/// few bits give the same leaves: docs/dev/decisions/vulkan_exact_distance.md.
uint32_t keyBitsFor(uint32_t triangles) {
  constexpr uint32_t kFewToSort = 100'000, kManyToSort = 4'000'000;
  return triangles <= kFewToSort ? 16 : triangles <= kManyToSort ? 24 : kMostKeyBits;
}

uint32_t nodesOver(uint32_t count) {
  return (count + kTreeArity - 1) / kTreeArity;
}

uint32_t roundUp(uint32_t count) {
  return nodesOver(count) * kTreeArity;
}

uint64_t frameBytes(uint32_t triangles) {
  return uint64_t{roundUp(triangles)} * kFrameVectors * 4 * sizeof(float);
}

/// The leaves come last.
uint64_t discBytes(const SurfaceTreeStage::Level& leaves) {
  return (uint64_t{leaves.start} + roundUp(leaves.count)) * kDiscVectors * 4 * sizeof(float);
}

}  // namespace

SurfaceTreeStage::SurfaceTreeStage(Device& device, int32_t rootError)
    : bounds_(device, shaders::kSurfaceTreeBounds, std::max(kGroup, device.limits().maxSubgroupSize)),
      keys_(device, shaders::kSurfaceTreeKeys, kGroup),
      order_(device, shaders::kSurfaceTreeOrder, kRun / 2, {kRun}),
      leaves_(device, shaders::kSurfaceTreeLeaves, kGroup,
              {kGroup / kTreeArity, static_cast<uint32_t>(rootError)}),
      level_(device, shaders::kSurfaceTreeLevel, kLevelGroup,
             {kLevelGroup, static_cast<uint32_t>(rootError)}),
      sort_(device),
      meshBounds_(device, "bounds of the mesh"),
      sortKeys_{DeviceBuffer(device, "keys of triangles"), DeviceBuffer(device, "other keys of triangles")},
      triangles_{DeviceBuffer(device, "order of triangles"),
                 DeviceBuffer(device, "other order of triangles")},
      frames_(device, "triangles in frames"),
      discs_(device, "discs") {}

void SurfaceTreeStage::reserve(uint32_t triangles) {
  if (triangles == 0 || triangles > kMostTriangles)
    throw std::logic_error("a tree over no triangles, or more than 2^29");
  sort_.reserve(triangles);
  meshBounds_.resize<uint32_t>(kBoundsWords);
  for (int i = 0; i < 2; ++i) {
    sortKeys_[i].resize<uint32_t>(triangles);
    triangles_[i].resize<uint32_t>(triangles);
  }
  frames_.resize<std::byte>(frameBytes(triangles));
  discs_.resize<std::byte>(discBytes(placeLevels(triangles).front()));
  reserved_ = triangles;
}

uint64_t SurfaceTreeStage::bytesNeeded(uint64_t triangles) {
  if (triangles > kMostTriangles) return UINT64_MAX;
  const auto count = static_cast<uint32_t>(triangles);
  return 4 * triangles * sizeof(uint32_t) + frameBytes(count) + discBytes(placeLevels(count).front());
}

std::vector<SurfaceTreeStage::Level> SurfaceTreeStage::placeLevels(uint32_t triangles) {
  std::vector<Level> levels;
  for (uint32_t nodes = nodesOver(triangles);; nodes = nodesOver(nodes)) {
    levels.push_back({0, nodes});
    if (nodes == 1) break;
  }
  for (size_t level = levels.size() - 1; level-- > 0;)
    levels[level].start = levels[level + 1].start * kTreeArity + 1;
  return levels;
}

void SurfaceTreeStage::record(Commands& commands, const DeviceMesh& mesh, const glm::ivec3& dims) {
  if (mesh.triangleCount == 0 || mesh.triangleCount > reserved_)
    throw std::logic_error("a tree over no triangles, or more than reserved");
  triangleCount_ = mesh.triangleCount;
  levels_ = placeLevels(mesh.triangleCount);
  SurfaceTreePush push{.vertices = mesh.vertices,
                       .triangles = mesh.triangles,
                       .bounds = meshBounds_.address(),
                       .keys = sortKeys_[0].address(),
                       .order = triangles_[0].address(),
                       .frames = frames_.address(),
                       .discs = discs_.address(),
                       .vertexCount = mesh.vertexCount,
                       .triangleCount = mesh.triangleCount,
                       .dims = glm::uvec3(dims),
                       .levelStart = levels_[0].start,
                       .levelCount = levels_[0].count,
                       .keyBits = keyBitsFor(mesh.triangleCount)};
  commands.dispatch(bounds_, push, ceilDiv(mesh.vertexCount, kVerticesEach));
  commands.dispatch(keys_, push, mesh.triangleCount);
  push.order =
      sort_
          .record(commands, {push.keys, push.order}, {sortKeys_[1].address(), triangles_[1].address()},
                  mesh.triangleCount, push.keyBits)
          .values;
  commands.dispatch(order_, push, (uint64_t{mesh.triangleCount} + 1) / 2);
  commands.dispatch(leaves_, push, uint64_t{roundUp(push.levelCount)} * kTreeArity);
  for (size_t level = 1; level < levels_.size(); ++level) {
    push.levelStart = levels_[level].start;
    push.levelCount = levels_[level].count;
    push.levelBelowCount = levels_[level - 1].count;
    commands.dispatch(level_, push, roundUp(push.levelCount));
    if (push.levelCount <= kLevelGroup) break;  // One group does the levels above, too.
  }
}

}  // namespace raymap::vulkan
