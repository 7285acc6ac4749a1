#pragma once

#include "crossings.h"

namespace raymap {

/// One entry of a ray map's line: r and its unsigned twin hold for samples up to and including `index`, down
/// to the entry before.
struct RayStep {
  int32_t index = 0;
  int32_t signedSum = 0;  ///< r (§3.5, Eq. 3-5): signed crossings from there to plus infinity.
  int32_t unsignedSum = 0;
};

/// §3.5, Eq. 3-8: r along the three axes. Between crossings r is constant, so a line keeps only its steps:
/// the same values as a dense grid of suffix sums, in memory that grows with the surface.
struct RayMap {
  struct Axis {
    Buffer<uint64_t> starts;
    Buffer<RayStep> steps;
  };
  glm::ivec3 dims{0};
  std::array<Axis, 3> axes;

  /// Eq. 7: r of `sample` along `axis`; samples outside the grid are allowed.
  int32_t ray(int axis, glm::ivec3 sample) const;
  /// Eq. 6: signed crossings of the segment from `from` towards `to` along `axis`.
  int32_t segment(int axis, glm::ivec3 from, int to) const;
};

void buildRayMap(glm::ivec3 dims, const Crossings& crossings, RayMap& map);

}  // namespace raymap
