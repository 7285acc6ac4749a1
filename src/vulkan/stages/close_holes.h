#pragma once

#include "method/close_holes_patch.h"
#include "vulkan/stages/close_holes_push.h"
#include "vulkan/stages/crossings.h"
#include "vulkan/stages/exact_distance.h"
#include "vulkan/stages/winding_dipoles.h"

namespace raymap::vulkan {

/// GPU twin of cpu/sign/close_holes.h. Finds for the host where surface is missing, and computes distances to
/// the patch that the host makes there (method/close_holes_patch.h).
class CloseHolesStage {
 public:
  explicit CloseHolesStage(Device& device);

  /// Searches for missing edges. Counts all of them, and lists as many as the capacity allows.
  void recordSearch(Commands& commands, const glm::ivec3& dims, const CrossedEdges& crossed,
                    VkDeviceAddress winding, double threshold);
  /// Computes the winding numbers of the tree's triangles at these points.
  void recordNumbersAt(Commands& commands, WindingDipolesStage& dipoles, const SurfaceTreeStage& tree,
                       std::span<const glm::vec3> points, double threshold);
  /// Replaces distances by those to the patch where these are shorter.
  void recordDistance(Commands& commands, const HolePatch& patch, const ExactDistanceStage::Fields& fields);

  // Valid when the work is done:
  /// Reserves memory for all edges if the capacity did not suffice. Returns whether it did so.
  bool growIfFull();
  /// Returns the edges in the order of their samples and axes.
  std::vector<MissingEdge> edges() const;
  std::vector<float> numbers() const;

 private:
  Kernel<CloseHolesPush> search_;
  DeviceBuffer count_, hostCount_, edges_, hostEdges_;
  DeviceBuffer points_, numbers_, hostNumbers_;
  uint32_t room_ = 0;
  DeviceBuffer patchVertices_, patchTriangles_;
  SurfaceTreeStage patchTree_;
  ExactDistanceStage patchDistance_;
};

}  // namespace raymap::vulkan
