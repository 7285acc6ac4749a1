#pragma once

#include <raymap/error.h>

#include <array>
#include <glm/vec3.hpp>
#include <optional>

#include "vulkan/primitives/dispatch_arguments.h"
#include "vulkan/primitives/scan.h"
#include "vulkan/stages/crossings_push.h"
#include "vulkan/stages/device_mesh.h"

namespace raymap::vulkan {

/// Addresses of three arrays of numbers, one for each lattice edge along x, y and z. A line along an axis
/// with n samples has n + 1 edges. Edge e leads from sample e - 1 to sample e. Edge 0 stands for everything
/// before the first sample, edge n for everything beyond the last. In memory each array is a grid with one
/// more sample along its axis, x fastest.
struct LatticeLines {
  glm::ivec3 dims{0};
  std::array<VkDeviceAddress, 3> axes{};
};

/// One bit per lattice edge: whether any triangle crosses it, in either direction (crossed_edges.glsl).
struct CrossedEdges {
  VkDeviceAddress bits = 0;
  uint32_t words = 0;  ///< Words for the edges along each axis.
};

/// Counts the signed crossings w_l of every lattice edge, with the CPU's results: §3.5, see
/// cpu/sign/crossings.h. Optionally keeps one bit per edge that tells whether any triangle crosses it.
class CrossingsStage {
 public:
  explicit CrossingsStage(Device& device, ScratchMemory* scratch = nullptr);

  /// Reserves memory for grids of these dims and this many triangles. All previously recorded work must have
  /// completed. Throws `Error(Unsupported)` if the edges or corners are too many to be numbered.
  void reserve(const glm::ivec3& dims, uint64_t triangleCount, bool keepsCrossed = false);
  /// Records the stage. The mesh must have at most as many triangles as were reserved.
  void record(Commands& commands, const DeviceMesh& mesh);

  LatticeLines lines() const;
  /// Returns the bits of the crossed edges; valid if `reserve` had `keepsCrossed` set.
  CrossedEdges crossed() const { return {crossed_.address(), crossedWords_}; }
  const DeviceBuffer& line(int axis) const { return lines_[static_cast<size_t>(axis)]; }
  /// Buffer of one `CrossingsStatus`, for `failureOf` when the work is done.
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

/// Returns the error that kept the crossings from being counted, if any: `Error(Input)` if a vertex lies too
/// far away, `Error(Unsupported)` if large triangles cover too many lines.
std::optional<Error> failureOf(const CrossingsStatus& status);

}  // namespace raymap::vulkan
