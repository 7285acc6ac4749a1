#include "second.h"

#include <raymap/narrow_band.h>
#include <raymap/sample.h>

#include <algorithm>

namespace raymap::view {

namespace {

/// Returns a field's distances on another grid. Numbers of other kinds are left out.
Field sampledOn(const Grid& grid, const Field& field) {
  Field result{.grid = grid,
               .distance = raymap::Buffer<float>(grid.sampleCount()),
               .clampDistance = field.clampDistance,
               .surfaceBounds = field.surfaceBounds};
  std::vector<glm::dvec3> sheet(size_t(grid.dims.x) * size_t(grid.dims.y));
  Samples samples;
  for (int k = 0; k < grid.dims.z; ++k) {
    for (int j = 0, p = 0; j < grid.dims.y; ++j)
      for (int i = 0; i < grid.dims.x; ++i, ++p) sheet[size_t(p)] = grid.position({i, j, k});
    sample(field, sheet, {}, samples);
    std::ranges::copy(samples.distance, result.distance.data() + grid.index({0, 0, k}));
  }
  return result;
}

/// A device draws no difference from a narrow band.
void makeDense(Content& content) {
  if (content.field && content.field->narrow) content.field = toDense(*content.field);
}

}  // namespace

void makeComparable(Content& first, Content& second) {
  for (Content* content : {&first, &second}) makeDense(*content);
  first.bounds = second.bounds = {glm::min(first.bounds.min, second.bounds.min),
                                  glm::max(first.bounds.max, second.bounds.max)};
  if (first.field && second.field) {
    if (first.field->grid != second.field->grid) second.field = sampledOn(first.field->grid, *second.field);
  } else if (first.field) {
    second.grid = first.field->grid;
  } else if (second.field) {
    first.grid = second.field->grid;
  }
}

}  // namespace raymap::view
