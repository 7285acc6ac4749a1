// Exact distance of arbitrary points, with the tree that the grid's samples use.

#include "cpu/distance/point_distance.h"

#include "base/parallel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/distance/point_distance.cpp"
#include <hwy/foreach_target.h>
// Must come after foreach_target.h.
#include <hwy/highway.h>

#include "cpu/distance/nearest_search-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raymap::cpu::HWY_NAMESPACE {

void measurePoints(const SurfaceTree& tree, std::span<const glm::vec3> points, std::span<float> distances) {
  // Keeps the upper bound of the next distance above it in spite of rounding.
  constexpr float kSlack = 1.001f;
  const NearestSearch<Ties::Any> search(tree);
  float known = INFINITY;
  for (size_t i = 0; i < points.size(); ++i) {
    if (i > 0) known = kSlack * (distances[i - 1] + glm::distance(points[i], points[i - 1]));
    distances[i] = std::sqrt(search.lookAround(points[i], known * known));
  }
}

}  // namespace raymap::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raymap::cpu {

HWY_EXPORT(measurePoints);

void computePointDistances(const SurfaceTree& tree, std::span<const glm::vec3> points,
                           std::span<float> distances) {
  constexpr size_t kPointsPerTask = 4096;
  parallelFor(points.size(), kPointsPerTask, [&](size_t begin, size_t end) {
    HWY_DYNAMIC_DISPATCH(measurePoints)
    (tree, points.subspan(begin, end - begin), distances.subspan(begin, end - begin));
  });
}

}  // namespace raymap::cpu
#endif
