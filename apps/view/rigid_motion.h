#pragma once

#include <raymap/animation.h>

#include <array>
#include <optional>
#include <vector>

namespace raymap::view {

/// A rotation about the origin, and then a translation.
struct RigidMotion {
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
  glm::dvec3 translation{0.0};
  bool operator==(const RigidMotion&) const = default;
};

/// Finds the poses of an animated mesh that differ by a rigid motion: the field of one, moved, is that of the
/// other.
class RigidPoses {
 public:
  /// The mesh must outlive it.
  explicit RigidPoses(const AnimatedMesh& mesh);

  /// Returns the motion from the pose at one time to that at another; none if it is not rigid. It is exactly
  /// the motion that does nothing if the poses are the same.
  std::optional<RigidMotion> between(double from, double to) const;

 private:
  const AnimatedMesh& mesh_;
  std::vector<size_t> joints_;              ///< Joints that move vertices.
  std::array<glm::dvec3, 8> corners_ = {};  ///< Corners of the bounds at rest.
  double size_ = 0.0;                       ///< Longest distance between them.
};

}  // namespace raymap::view
