// Samples that a run of exact_distance.cpp reads and writes. Compiled once per instruction set.

#include <raymap/field.h>

#include <algorithm>
#include <cmath>

#include "cpu/distance/exact_distance_candidates-inl.h"
#include "cpu/distance/exact_distance_job.h"
#include "cpu/distance/nearest_search-inl.h"

#if defined(RAYMAP_EXACT_DISTANCE_SAMPLES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYMAP_EXACT_DISTANCE_SAMPLES_INL_H
#undef RAYMAP_EXACT_DISTANCE_SAMPLES_INL_H
#else
#define RAYMAP_EXACT_DISTANCE_SAMPLES_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {

/// Access to the grid's samples.
class SampleGrid {
 public:
  explicit SampleGrid(const ExactDistanceJob& job) : job_(job) {}

  /// Returns which of the eight positions from `low` on, `step` apart, are samples of the grid.
  HWY_INLINE uint32_t from(glm::ivec3 low, int step) const {
    const glm::ivec3 high = low + step;
    if (high.x < job_.dims.x && high.y < job_.dims.y && high.z < job_.dims.z) return 0xff;
    const uint32_t x = high.x < job_.dims.x ? 0xff : 0x55, y = high.y < job_.dims.y ? 0xff : 0x33,
                   z = high.z < job_.dims.z ? 0xff : 0x0f;
    return x & y & z;
  }

  /// Returns the active halves without those whose samples are all as close to earlier triangles.
  uint32_t skipClose(glm::ivec3 low, int half, float reach, uint32_t active, const Level& level) const {
    uint32_t rest = active;
    forEachLane(active, [&](size_t lane) {
      const float closest = level.distance.v[lane] - reach * std::sqrt(3.0f) - job_.tolerance;
      if (!isAnyFarther(low + half * octant(lane), half, closest)) rest &= ~(1u << lane);
    });
    return rest;
  }

  /// Fills the active halves that the band does not reach. Returns the others.
  uint32_t skipFar(glm::ivec3 low, int half, float reach, uint32_t active, const Level& level) const {
    uint32_t rest = active;
    forEachLane(active, [&](size_t lane) {
      if (level.distance.v[lane] - reach * std::sqrt(3.0f) <= job_.band) return;
      rest &= ~(1u << lane);
      const glm::ivec3 begin = low + half * octant(lane);
      const glm::ivec3 end = glm::min(begin + half, job_.dims);
      for (int z = begin.z; z < end.z; ++z)
        for (int y = begin.y; y < end.y; ++y) {
          const size_t row = (size_t(z) * job_.dims.y + y) * job_.dims.x;
          std::fill(job_.distance + row + begin.x, job_.distance + row + end.x, job_.band);
          if (job_.triangle)
            std::fill(job_.triangle + row + begin.x, job_.triangle + row + end.x, kNoTriangle);
        }
    });
    return rest;
  }

  void write(glm::ivec3 low, const NearestOfLanes& nearest, size_t half, uint32_t samples) const {
    Lanes distance;
    for (size_t i = 0; i < kLanes; i += hn::Lanes(Tag()))
      distance.store(i, hn::Sqrt(nearest.squared[half].load(i)));
    forEachLane(samples, [&](size_t s) {
      const glm::ivec3 p = low + octant(s);
      const size_t index = (size_t(p.z) * job_.dims.y + p.y) * job_.dims.x + p.x;
      if (job_.isAddition && !(distance.v[s] < job_.distance[index])) return;
      const bool beyond = job_.band > 0.0f && distance.v[s] > job_.band;
      job_.distance[index] = beyond ? job_.band : distance.v[s];
      if (job_.triangle)
        job_.triangle[index] =
            beyond || job_.isAddition ? kNoTriangle : job_.tree.triangleId(nearest.closest[half][s]);
    });
  }

 private:
  bool isAnyFarther(glm::ivec3 begin, int half, float distance) const {
    const glm::ivec3 end = glm::min(begin + half, job_.dims);
    for (int z = begin.z; z < end.z; ++z)
      for (int y = begin.y; y < end.y; ++y) {
        const float* row = job_.distance + (size_t(z) * job_.dims.y + y) * job_.dims.x;
        if (std::any_of(row + begin.x, row + end.x, [&](float d) { return d > distance; })) return true;
      }
    return false;
  }

  const ExactDistanceJob& job_;
};

}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
