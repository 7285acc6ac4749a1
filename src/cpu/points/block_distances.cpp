#include "cpu/points/block_distances.h"

#include <cmath>

#include "cpu/points/point_cells.h"
#include "cpu/points/segment_crossings.h"

namespace raymap::cpu {

void BlockDistances::find(const LatticeBlock& block, std::span<const glm::dvec3> points,
                          std::span<const uint16_t> codes, double most, std::span<double> distances,
                          std::span<uint32_t> triangles) {
  if (points.empty()) return;
  const auto side = uint64_t(block.side);
  // From one place of the block to the next on the search's curve.
  const uint64_t step = (uint64_t{1} << (3 * kCurveBits)) / (side * side * side);
  cells_.resize(points.size()), codes_.resize(points.size()), nearest_.resize(points.size());
  for (size_t k = 0; k < points.size(); ++k) {
    cells_[k] = toCells(surface_.grid, points[k]);
    codes_[k] = codes[k] * step;
  }
  SortedPoints sorted{cells_, codes_, toCells(surface_.grid, block.low - 0.5 * block.spacing),
                      float(double(block.side) * block.spacing / surface_.grid.spacing)};
  const double limit = most / surface_.grid.spacing;
  findNearestTriangles(surface_.tree, sorted, float(limit), nearest_);
  // Single precision tells of the others that they are beyond.
  constexpr double kRounding = 1.0 + 1e-5;
  const double slack = 2.0 * double(slackOf(surface_.tree, surface_.grid.dims));
  const auto beyond = float(std::pow(limit * kRounding + slack, 2.0));
  near_.clear(), nearTriangles_.clear(), nearPoints_.clear();
  for (uint32_t k = 0; k < points.size(); ++k) {
    distances[k] = most;
    triangles[k] = kNoTriangle;
    if (nearest_[k].triangle == kNoTriangle || nearest_[k].squared > beyond) continue;
    near_.push_back(k);
    nearTriangles_.push_back(surface_.tree.triangleId(nearest_[k].triangle));
    nearPoints_.push_back(points[k] - surface_.mesh.origin);
  }
  closest_.resize(near_.size());
  findClosestPoints(surface_.mesh, nearPoints_, nearTriangles_, closest_);
  for (size_t i = 0; i < near_.size(); ++i) {
    const double distance = glm::length(nearPoints_[i] - closest_[i].position);
    if (distance > most) continue;
    distances[near_[i]] = distance;
    triangles[near_[i]] = nearTriangles_[i];
  }
}

}  // namespace raymap::cpu
