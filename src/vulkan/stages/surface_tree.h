#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "vulkan/primitives/radix_sort.h"
#include "vulkan/stages/device_mesh.h"
#include "vulkan/stages/surface_tree_push.h"

namespace raymap::vulkan {

/// The CPU's twin: triangles in the order of a space-filling curve, eight to a leaf, and discs around leaves
/// and around eight nodes each of the level below. Numbered from the root on (shaders/surface_shapes.glsl).
class SurfaceTreeStage {
 public:
  /// The nodes of a level: `count` of them from `start` on.
  struct Level {
    uint32_t start, count;
  };

  /// Of a tree over so many triangles, leaves first.
  static std::vector<Level> placeLevels(uint32_t triangles);

  explicit SurfaceTreeStage(Device& device);

  /// Makes room for meshes of up to so many triangles, at least one. Nothing recorded before may still have
  /// to run.
  void reserve(uint32_t triangles);
  /// For up to as many triangles as were reserved.
  void record(Commands& commands, const DeviceMesh& mesh, const glm::ivec3& dims);

  /// Of the mesh of the last `record`.
  const DeviceBuffer& frames() const { return frames_; }
  const DeviceBuffer& discs() const { return discs_; }
  uint32_t triangleCount() const { return triangleCount_; }
  const std::vector<Level>& levels() const { return levels_; }
  /// The number of the first leaf among all nodes, of which the leaves come last.
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
