#include "method/winding_paths_offsets.h"

#include <algorithm>
#include <cmath>

namespace raymap {

namespace {

// Sides of the box of built-in offset points, as a share of the grid's sides. A longer path crosses more
// broken surface; if all paths are short, they all see the same. docs/signs.md has figures for other sizes.
constexpr double kBox = 3.0 / 16.0;

// Offset points per pass or step. Evolution: with one point the field would nearly be that point's.
constexpr int kSpreadPoints = 1, kSpreadPointsOfStep = 4, kNeighbours = 8;

/// Returns a point of `Sampling::Spread`. The points are an additive low-discrepancy sequence (Roberts
/// 2018) over a box around the sample, so that any number of passes is well spaced.
glm::ivec3 spreadOffset(int64_t point, const glm::ivec3& dims) {
  constexpr double kRoot = 1.2207440846057596;  // x^4 = x + 1
  const double steps[3] = {1.0 / kRoot, 1.0 / (kRoot * kRoot), 1.0 / (kRoot * kRoot * kRoot)};
  glm::ivec3 offset;
  for (int c = 0; c < 3; ++c) {
    const double turn = 0.5 + double(point + 1) * steps[c];
    offset[c] = static_cast<int>(std::lround((turn - std::floor(turn) - 0.5) * kBox * dims[c]));
  }
  return offset;
}

/// Returns a point of `Sampling::Paper`. The paper names no points. Its example has "eight neighbors with six
/// paths each", and its simple variant "different offset points for each iteration step". Here: the eight
/// cells diagonal to the sample's, at twice the distance in each further pass. After a quarter of the longest
/// side the distance begins again at one cell.
glm::ivec3 neighbourOffset(int64_t point, const glm::ivec3& dims) {
  const int longest = std::max({dims.x, dims.y, dims.z});
  int distances = 1;
  while (longest >> (distances + 2) > 0) ++distances;
  const int distance = 1 << (point / kNeighbours % distances);
  const auto along = [&](int axis) { return (point >> axis & 1) != 0 ? distance : -distance; };
  return {along(0), along(1), along(2)};
}

}  // namespace

int pointsPerPass(const FieldOptions& options) {
  if (options.sampling == Sampling::Paper) return kNeighbours;
  return options.sign == SignMode::Evolution ? kSpreadPointsOfStep : kSpreadPoints;
}

glm::ivec3 offsetOf(const FieldOptions& options, int64_t point, const glm::ivec3& dims) {
  if (!options.offsets.empty())
    // With an offset of `dims` the point lies outside for every sample; a larger offset changes nothing.
    return glm::clamp(options.offsets[size_t(point) % options.offsets.size()], -dims, dims);
  return options.sampling == Sampling::Paper ? neighbourOffset(point, dims) : spreadOffset(point, dims);
}

}  // namespace raymap
