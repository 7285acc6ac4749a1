#pragma once

#include "cpu/sign/crossings.h"

namespace raymap::cpu {

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

    std::span<const RayStep> line(size_t id) const {
      return {steps.data() + starts[id], size_t(starts[id + 1] - starts[id])};
    }
  };
  glm::ivec3 dims{0};
  std::array<Axis, 3> axes;

  /// Eq. 7: r of `sample` along `axis`; samples outside the grid are allowed. Paper: no crossings lie outside
  /// the grid. Here: those before the first and beyond the last sample of a line count, at index -1 and m.
  int32_t ray(int axis, glm::ivec3 sample) const;
  /// Its twin: faces crossed, whichever way they point.
  int32_t unsignedRay(int axis, glm::ivec3 sample) const;
  /// Eq. 6: signed crossings of the segment from `from` along `axis` to coordinate `to`.
  int32_t segment(int axis, glm::ivec3 from, int to) const;
  /// Signed crossings of a whole line: the ray from before the first sample.
  int32_t total(int axis, size_t line) const;

 private:
  const RayStep* find(int axis, const glm::ivec3& sample) const;
};

void buildRayMap(glm::ivec3 dims, const Crossings& crossings, RayMap& map);

}  // namespace raymap::cpu
