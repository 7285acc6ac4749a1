#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "vulkan/primitives/radix_sort.h"
#include "vulkan/stages/device_mesh.h"
#include "vulkan/stages/surface_tree_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/distance/surface_tree.h: triangles in the order of a space-filling curve, eight per leaf.
/// Discs bound leaves, and eight nodes each of the level below. Nodes are numbered from the root on
/// (vulkan/stages/surface_shapes.glsl).
class SurfaceTreeStage {
 public:
  /// Nodes of a level: `count` of them from `start` on.
  struct Level {
    uint32_t start, count;
  };

  /// Returns the levels of a tree over this many triangles, leaves first.
  static std::vector<Level> placeLevels(uint32_t triangles);

  /// Tests imitate devices whose roots for bounds are off by `rootError` units in the last place.
  explicit SurfaceTreeStage(Device& device, int32_t rootError = 0);

  /// Reserves memory for meshes of up to this many triangles, at least one. All previously recorded work must
  /// have completed.
  void reserve(uint32_t triangles);
  /// Returns the bytes that `reserve` takes, without the sort's bins: less than a byte per triangle.
  /// UINT64_MAX if no tree can have so many.
  static uint64_t bytesNeeded(uint64_t triangles);
  /// Clears the bounds of the mesh, once before each `record`. A step less where it runs beside others.
  void recordClear(Commands& commands) const { commands.fill(meshBounds_, UINT32_MAX); }
  /// Records the stage. The mesh must have at most as many triangles as were reserved.
  void record(Commands& commands, const DeviceMesh& mesh, const glm::ivec3& dims);

  /// Tree of the mesh of the last `record`.
  const DeviceBuffer& frames() const { return frames_; }
  const DeviceBuffer& discs() const { return discs_; }
  uint32_t triangleCount() const { return triangleCount_; }
  const std::vector<Level>& levels() const { return levels_; }
  /// Index of the first leaf among all nodes; the leaves come last.
  uint32_t firstLeaf() const { return levels_.front().start; }
  uint32_t leafCount() const { return levels_.front().count; }

 private:
  Kernel<SurfaceTreePush> bounds_, keys_, order_, leaves_, level_;
  RadixSort sort_;
  uint32_t reserved_ = 0;
  uint32_t triangleCount_ = 0;
  std::vector<Level> levels_;
  DeviceBuffer meshBounds_;
  DeviceBuffer sortKeys_[2], triangles_[2];
  DeviceBuffer frames_, discs_;
};

}  // namespace raymap::vulkan
