#pragma once

#include <raymap/buffer.h>

#include <array>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "mesh/rim_edges.h"

namespace raymap::cpu {

/// What the rims of a surface add to the crossings along a ray.
struct RimShare {
  double winding = 0.0;
  /// How far the ray passes the rims by, as an angle, about: 0 if it meets one. The error of `winding` is
  /// some 1e-16 divided by this, unless a larger one was allowed.
  double clearance = 4.0;
};

/// How the winding number changes in a ball that no rim meets: on a way that crosses no face, by
/// dot(`slope`, way) within `bend`.
struct RimChange {
  glm::dvec3 slope{0.0};
  double bend = 0.0;  ///< Infinite if a rim may meet the ball, or if with many rims it exceeds one half.
};

/// Rims one after the other: each vertex is the end of the rim before it and the start of the next.
struct RimPaths {
  std::array<Buffer<float>, 3> vertices;
  Buffer<float> isStart;  ///< By vertex: 1 if a rim begins there, 0 if a path ends.

  glm::vec3 vertex(size_t i) const { return {vertices[0][i], vertices[1][i], vertices[2][i]}; }
};

/// Exact winding numbers from one ray and the rims: Martens, Trettner & Bessmeltsev 2026, "The Antipodal
/// Method: Fast, Accurate, and Robust 3D Generalized Winding Numbers".
class WindingRims {
 public:
  WindingRims() = default;
  explicit WindingRims(std::span<const RimLine> rims);

  /// Returns what the rims add at a point: the winding number there is the crossings of the ray along the
  /// unit vector `direction`, +1 where it leaves through a face's front and -1 through a back, and this. The
  /// point must be closer than 1e10 times the size of the rims. An error of up to `allowed` costs less.
  RimShare at(const glm::dvec3& point, const glm::dvec3& direction, double allowed = 0.0) const;

  /// Returns how the winding number changes in a ball. The gradient follows the law of Biot and Savart. At a
  /// distance D from a rim of length l it is at most l / 4 pi D^2, and changes by at most 2 l / 4 pi D^3.
  /// With many rims the slope is 0, and the first bound alone holds.
  RimChange changeIn(const glm::dvec3& centre, double radius) const;

  size_t count() const { return count_; }
  size_t bytes() const { return 4 * paths_.isStart.capacityBytes() + groups_.capacity() * sizeof(Group); }

 private:
  /// Vertices that follow each other, the ball that holds the rims from them on, and the length of these.
  /// The groups of its halves follow each one, before the next.
  struct Group {
    size_t begin, end, next;
    glm::vec3 centre;
    float radius, length;
  };

  void makeGroups(size_t begin, size_t end);
  double mostGradient(const glm::vec3& centre, float reach) const;
  float gradientOf(const Group& group, const glm::vec3& centre, float reach) const;

  size_t count_ = 0;
  double scale_ = 1.0;  ///< Factor of all positions, so that no square leaves the range of floats.
  RimPaths paths_;
  std::vector<Group> groups_;  ///< Filled if rims are many.
};

}  // namespace raymap::cpu
