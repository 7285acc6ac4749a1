#pragma once

#include "vulkan/device/commands.h"
#include "vulkan/stages/crossings.h"
#include "vulkan/stages/orientation_push.h"

namespace raymap::vulkan {

/// The CPU's twin: what a field says about the way the faces point, for the host.
class OrientationStage {
 public:
  struct Fields {
    LatticeLines rays;          ///< The ray map.
    VkDeviceAddress field = 0;  ///< Of every sample.
    DeviceMesh mesh;
    double threshold = 0.5;
  };

  explicit OrientationStage(Device& device);

  /// Nothing recorded before may still have to run.
  void reserve(const glm::ivec3& dims, uint32_t triangleCount);

  void recordMisfit(Commands& commands, const Fields& fields);
  /// Fills the field with the share of the six rays that cross an odd number of faces.
  void recordParity(Commands& commands, const Fields& fields);
  /// With `farSides` steps along the normals are as long as so many roots of twice a face's area.
  void recordRises(Commands& commands, const Fields& fields, float farSides);

  // When the work has been done:
  double misfit() const;
  /// Whether any sign contradicted the parity of all six rays when the misfit was measured.
  bool contradictsParity() const;
  std::span<const float> rises() const { return hostRises_.mapped<const float>(); }

 private:
  OrientationPush push(const Fields& fields, float farSides = 0.0f) const;

  Kernel<OrientationPush> misfitOf_, parityOf_, risesOf_;
  DeviceBuffer sums_, hostSums_, rises_, hostRises_;
  uint64_t samples_ = 0;
  uint32_t triangleCount_ = 0;
};

}  // namespace raymap::vulkan
