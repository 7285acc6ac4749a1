#pragma once

#include <optional>
#include <span>

#include "vulkan/stages/cell_mesh.h"
#include "vulkan/stages/face_search_push.h"

namespace raymap::vulkan {

/// Twin of the searches over all faces in mesh/rim_edges.h and mesh/double_sided.h: lists the edges that may
/// be rims, and the faces that may lie on one another. The host looks at these alone.
class FaceSearchStage {
 public:
  /// More edges or faces are not listed: the host then looks at all. So many belong to soups, whose winding
  /// numbers do not follow from rims.
  static constexpr uint32_t kMostListed = 1 << 15;

  /// With scratch memory, tables are overwritten by the next phase.
  explicit FaceSearchStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Reserves memory for meshes of at most this size. All previously recorded work must have completed.
  void reserve(uint32_t vertices, uint32_t triangles);
  /// Returns the address of one 64-bit hash per vertex. `CellMeshStage::record` writes them.
  VkDeviceAddress vertexHashes() const { return vertexHashes_.address(); }
  /// Records the search in a mesh whose hashes are written.
  void record(Commands& commands, const DeviceMesh& mesh);

  // Valid when the work is done, and empty if there are more than are listed:
  /// Returns edges in any order, as `findRimEdges` takes them.
  std::optional<std::span<const uint32_t>> edges() const { return listed(0); }
  /// Returns faces in any order, as `findDoubleSidedFaces` takes them.
  std::optional<std::span<const uint32_t>> faces() const { return listed(1); }

 private:
  std::optional<std::span<const uint32_t>> listed(uint32_t list) const;

  Kernel<FaceSearchPush> count_, list_;
  DeviceBuffer vertexHashes_, tables_;
  DeviceBuffer lists_, hostLists_;  // Both counts, edges, faces.
  uint32_t room_ = 0, sumCount_ = 0, hashCount_ = 0;
};

}  // namespace raymap::vulkan
