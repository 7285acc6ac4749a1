// A field on another grid, for a page.

#include "render/resample.h"

#include <raymap/generate.h>
#include <raymap/isosurface.h>

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

/// Moves the faces that close a solid half a sample beyond the box of a grid far away: no point of the box is
/// closer to them than to the solid's surface.
void moveLidsAway(const Grid& grid, Mesh& surface) {
  constexpr double kBeyond = 0.1;  // Samples; rounding moves no vertex within the box so far.
  const glm::dvec3 last(grid.dims - 1), origin = surface.origin - grid.origin;
  const double away = 1.0 + glm::length(last);
  for (glm::vec3& vertex : surface.vertices)
    for (int a = 0; a < 3; ++a) {
      const double place = (origin[a] + double(vertex[a])) / grid.spacing;
      if (place < -kBeyond) vertex[a] = float(-away * grid.spacing - origin[a]);
      if (place > last[a] + kBeyond) vertex[a] = float((last[a] + away) * grid.spacing - origin[a]);
    }
}

Field resampledBand(const Field& band, const Grid& grid, const MachineOptions& machine) {
  MachineOptions quiet = machine;
  quiet.warn = nullptr;  // The surface is not closed at the grid's box after all.
  Mesh surface = isosurface(band, {}, quiet);
  moveLidsAway(band.grid, surface);
  return generate(surface, grid, {.orientation = Orientation::Keep}, machine).field;
}

}  // namespace

Field resampled(const Field& field, const Grid& grid, const MachineOptions& machine) {
  if (field.narrow) return resampledBand(field, grid, machine);
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
