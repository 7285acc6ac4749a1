#pragma once

#include "method/orientation_sides.h"
#include "vulkan/device/commands.h"
#include "vulkan/stages/crossings.h"
#include "vulkan/stages/orientation_push.h"

namespace raymap::vulkan {

/// GPU twin of cpu/sign/orientation.h. Measures for the host which way the faces point according to a field.
class OrientationStage {
 public:
  struct Fields {
    LatticeLines rays;          ///< The ray map.
    VkDeviceAddress field = 0;  ///< One value per sample.
    DeviceMesh mesh;
    double threshold = 0.5;
  };

  explicit OrientationStage(Device& device);

  /// Reserves memory. All previously recorded work must have completed.
  void reserve(const glm::ivec3& dims, uint32_t triangleCount);

  void recordMisfit(Commands& commands, const Fields& fields);
  /// Fills the field with the share of the six rays that cross an odd number of faces.
  void recordParity(Commands& commands, const Fields& fields);
  /// Measures, in the mean over each face, the field a step in front of it and a step behind it. The step is
  /// `farSides` times the root of twice the face's area, and at least one cell.
  void recordSides(Commands& commands, const Fields& fields, float farSides, SideMeasure measure);

  // Valid when the work is done:
  double misfit() const;
  /// Returns whether any sign contradicted the parity of all six rays in the last measurement of the misfit.
  bool contradictsParity() const;
  std::span<const float> sides() const { return hostSides_.mapped<const float>(); }

 private:
  OrientationPush push(const Fields& fields, float farSides = 0.0f,
                       SideMeasure measure = SideMeasure::Rise) const;

  Kernel<OrientationPush> misfitOf_, parityOf_, sidesOf_;
  DeviceBuffer sums_, hostSums_, sides_, hostSides_;
  uint64_t samples_ = 0;
  uint32_t triangleCount_ = 0;
};

}  // namespace raymap::vulkan
