#pragma once

#include <raymap/error.h>

#include <array>
#include <glm/vec3.hpp>
#include <optional>

#include "vulkan/primitives/scan.h"
#include "vulkan/stages/crossings_push.h"
#include "vulkan/stages/device_mesh.h"

namespace raymap::vulkan {

/// Where three arrays of numbers lie, one for each lattice edge along x, y and z. A line along an axis with n
/// samples has n + 1 of them: edge e leads from sample e - 1 to e, edge 0 stands for all that lies before the
/// first sample, edge n for all beyond the last. In memory each array is a grid with one sample more along
/// its axis, x fastest.
struct LatticeLines {
  glm::ivec3 dims{0};
  std::array<VkDeviceAddress, 3> axes{};
};

/// Which of these edges any triangle crosses, whichever way it points: a bit each (crossed_edges.glsl).
struct CrossedEdges {
  VkDeviceAddress bits = 0;
  uint32_t words = 0;  ///< For the edges along each axis.
};

/// Signed crossings w_l of every lattice edge, the same as the CPU's: §3.5, see cpu/crossings.h. Of unsigned
/// ones only whether there are any.
class CrossingsStage {
 public:
  explicit CrossingsStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Makes room for grids of these dims and so many triangles. Nothing recorded before may still have to run.
  /// Throws `Error(Unsupported)` if there are more edges or corners than can be numbered.
  void reserve(const glm::ivec3& dims, uint64_t triangleCount, bool keepsCrossed = false);
  /// Counts the crossings of up to as many triangles as were reserved.
  void record(Commands& commands, const DeviceMesh& mesh);

  LatticeLines lines() const;
  /// If it was to keep them.
  CrossedEdges crossed() const { return {crossed_.address(), crossedWords_}; }
  const DeviceBuffer& line(int axis) const { return lines_[static_cast<size_t>(axis)]; }
  /// One `CrossingsStatus`, for `failureOf` when the work has been done.
  const DeviceBuffer& status() const { return status_; }

 private:
  glm::ivec3 dims_{0};
  Kernel<CrossingsPush> reach_;
  Kernel<CrossingsPush> triangles_;
  Kernel<CrossingsPush> runs_;
  Scan scan_;
  DispatchArguments arguments_;
  std::array<DeviceBuffer, 3> lines_;
  DeviceBuffer crossed_;
  uint32_t crossedWords_ = 0;
  DeviceBuffer runCounts_;
  DeviceBuffer status_;
};

/// What kept the crossings from being counted, if anything: `Error(Input)` if a vertex lies too far away,
/// `Error(Unsupported)` if large triangles cover too many lines.
std::optional<Error> failureOf(const CrossingsStatus& status);

}  // namespace raymap::vulkan
