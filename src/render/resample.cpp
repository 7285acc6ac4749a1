// A field on another grid, for a page.

#include "render/resample.h"

#include <algorithm>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "field/field_sampler.h"

namespace raymap {

namespace {

std::vector<glm::dvec3> sheetOf(const Grid& grid, int k) {
  std::vector<glm::dvec3> points;
  points.reserve(size_t(grid.dims.x) * size_t(grid.dims.y));
  for (int j = 0; j < grid.dims.y; ++j)
    for (int i = 0; i < grid.dims.x; ++i) points.push_back(grid.position({i, j, k}));
  return points;
}

Buffer<float> interpolated(const Buffer<float>& numbers, const Grid& from, const Grid& to) {
  if (numbers.empty()) return {};
  const Trilinear<double> between(from.dims, numbers.data());
  Buffer<float> result(to.sampleCount());
  parallelFor(size_t(to.dims.z), 1, [&](size_t k, size_t) {
    float* number = result.data() + to.index({0, 0, k});
    for (const glm::dvec3& point : sheetOf(to, int(k)))
      *number++ =
          float(between(glm::clamp((point - from.origin) / from.spacing, glm::dvec3(0.0), between.last())));
  });
  return result;
}

}  // namespace

Grid coarserGrid(const Grid& grid, int most) {
  const glm::ivec3 last = grid.dims - 1;
  const int longest = std::max({last.x, last.y, last.z});
  const glm::dvec3 sides = glm::ceil(glm::dvec3(last) * double(most - 1) / double(longest));
  return {
      .dims = glm::ivec3(sides) + 1, .origin = grid.origin, .spacing = grid.spacing * longest / (most - 1)};
}

Field resampled(const Field& field, const Grid& grid) {
  Field result{.grid = grid, .clampDistance = field.clampDistance, .surfaceBounds = field.surfaceBounds};
  result.distance = Buffer<float>(grid.sampleCount());
  for (int k = 0; k < grid.dims.z; ++k)
    sampleInto(field, sheetOf(grid, k), Outside::Bound, result.distance.data() + grid.index({0, 0, k}),
               nullptr);
  result.winding = interpolated(field.winding, field.grid, grid);
  result.confidence = interpolated(field.confidence, field.grid, grid);
  return result;
}

}  // namespace raymap
