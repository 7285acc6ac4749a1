#pragma once

#include "method/close_holes_patch.h"
#include "vulkan/stages/close_holes_push.h"
#include "vulkan/stages/crossings.h"
#include "vulkan/stages/exact_distance.h"
#include "vulkan/stages/winding_dipoles.h"

namespace raymap::vulkan {

/// The CPU's twin: where surface is missing, for the host, and distances to the patch that it makes of that
/// (hole_patch.h).
class CloseHolesStage {
 public:
  explicit CloseHolesStage(Device& device);

  /// Looks for missing edges, and lists them as far as there is room.
  void recordSearch(Commands& commands, const glm::ivec3& dims, const CrossedEdges& crossed,
                    VkDeviceAddress winding, double threshold);
  /// The winding numbers at some points, of the triangles in the tree.
  void recordNumbersAt(Commands& commands, WindingDipolesStage& dipoles, const SurfaceTreeStage& tree,
                       std::span<const glm::vec3> points, double threshold);
  /// Distances to a patch where they are shorter.
  void recordDistance(Commands& commands, const HolePatch& patch, const ExactDistanceStage::Fields& fields);

  // When the work has been done:
  /// Makes room for all edges if there was too little for them.
  bool growIfFull();
  /// In the order of their samples and axes.
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
