#pragma once

#include "cpu/sign/crossings.h"

namespace raymap::cpu {

/// Entry of a ray map's line. Its sums hold for the samples after the previous entry's `index`, up to and
/// including its own.
struct RayStep {
  int32_t index = 0;
  int32_t signedSum = 0;    ///< r (§3.5, Eq. 3-5): signed crossings from there to plus infinity.
  int32_t unsignedSum = 0;  ///< Number of faces crossed from there to plus infinity.
};

/// r along the three axes (§3.5, Eq. 3-8). Between crossings r is constant, so a line keeps only its steps.
/// They stand for a dense grid of suffix sums, in memory that grows with the surface.
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

  /// Returns r of `sample` along `axis` (Eq. 7). The sample may lie outside the grid. Paper: no crossings lie
  /// outside the grid. Here: those before a line's first sample and beyond its last are used, at index -1 and
  /// m, because the grid need not cover the mesh.
  int32_t ray(int axis, glm::ivec3 sample) const;
  /// Returns the number of faces that the same ray crosses, whichever way they point.
  int32_t unsignedRay(int axis, glm::ivec3 sample) const;
  /// Returns the signed crossings of the segment from `from` along `axis` to coordinate `to` (Eq. 6).
  int32_t segment(int axis, glm::ivec3 from, int to) const;
  /// Returns the signed crossings of a whole line: the ray from before the first sample.
  int32_t total(int axis, size_t line) const;

  size_t bytes() const;
  /// Returns the bytes of the ray map of these crossings.
  static size_t bytesNeeded(const Crossings& crossings);
  /// Returns the same for a mesh of which most lines meet `kExpectedCrossings`.
  static size_t bytesExpected(const glm::ivec3& dims);

 private:
  const RayStep* find(int axis, const glm::ivec3& sample) const;
};

void buildRayMap(glm::ivec3 dims, const Crossings& crossings, RayMap& map);

}  // namespace raymap::cpu
