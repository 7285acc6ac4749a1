// Krayer & Müller 2019, §3.5: the ray map's values, row by row.

#include "cpu/sign/ray_sweep.h"

#include <algorithm>

namespace raymap::cpu {

RaySweep::RaySweep(const RayMap& map)
    : map_(map),
      changes_{collectChanges(map, 1), collectChanges(map, 2)},
      totalZ_(map.axes[2].starts.size() - 1) {
  for (size_t line = 0; line < totalZ_.size(); ++line) totalZ_[line] = map.total(2, line);
}

/// Collects the changes with a counting sort by row. Lines with different v write to different rows, so v
/// runs in parallel.
RaySweep::Changes RaySweep::collectChanges(const RayMap& map, int axis) {
  const int nx = map.dims.x, ny = map.dims.y, nz = map.dims.z;
  const auto forEachChange = [&](auto&& work) {
    parallelFor(size_t(axis == 1 ? nz : ny), 8, [&](size_t vBegin, size_t vEnd) {
      for (size_t v = vBegin; v < vEnd; ++v)
        for (int32_t x = 0; x < nx; ++x) {
          const auto steps = map.axes[axis].line(v * size_t(nx) + size_t(x));
          for (size_t s = 0; s < steps.size() && steps[s].index + 1 < map.dims[axis]; ++s) {
            const int32_t after = s + 1 < steps.size() ? steps[s + 1].signedSum : 0;
            if (after == steps[s].signedSum) continue;
            const size_t sample = size_t(steps[s].index) + 1;
            work(axis == 1 ? v * size_t(ny) + sample : sample * size_t(ny) + v,
                 Change{x, after - steps[s].signedSum});
          }
        }
    });
  };
  Changes result;
  result.starts.assign(size_t(ny) * size_t(nz) + 1, 0);
  forEachChange([&](size_t row, const Change&) { ++result.starts[row]; });
  uint32_t total = 0;
  for (uint32_t& start : result.starts) total += std::exchange(start, total);
  result.changes.resize(total);
  forEachChange([&](size_t row, const Change& change) { result.changes[result.starts[row]++] = change; });
  // Each start has become its row's end, which is the next row's start.
  result.starts.insert(result.starts.begin(), 0);
  return result;
}

void RaySweep::startSlab(int k, State& state) const {
  const int nx = map_.dims.x, ny = map_.dims.y;
  state.x.resize(size_t(nx));
  state.y.resize(size_t(nx));
  state.totalY.resize(size_t(nx));
  state.z.resize(size_t(nx) * size_t(ny));
  // The values belong to plane k - 1: the changes of plane k then lead to r at k.
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) state.z[size_t(j) * nx + i] = map_.ray(2, {i, j, k - 1});
}

void RaySweep::startPlane(int k, State& state) const {
  const size_t nx = size_t(map_.dims.x);
  for (size_t i = 0; i < nx; ++i) state.totalY[i] = map_.total(1, size_t(k) * nx + i);
  state.y = state.totalY;
}

RayRow RaySweep::advanceRow(int j, int k, State& state) const {
  const size_t nx = size_t(map_.dims.x), row = size_t(k) * map_.dims.y + j;
  size_t i = 0;
  const auto steps = map_.axes[0].line(row);
  for (const RayStep& step : steps)
    for (; i < nx && int32_t(i) <= step.index; ++i) state.x[i] = step.signedSum;
  std::fill(state.x.begin() + ptrdiff_t(i), state.x.end(), 0);

  int32_t* z = state.z.data() + size_t(j) * nx;
  const auto apply = [&](const Changes& changes, int32_t* values) {
    for (uint32_t c = changes.starts[row]; c < changes.starts[row + 1]; ++c)
      values[changes.changes[c].x] += changes.changes[c].delta;
  };
  apply(changes_[0], state.y.data());
  apply(changes_[1], z);
  return {.j = j,
          .k = k,
          .first = row * nx,
          .x = state.x.data(),
          .y = state.y.data(),
          .z = z,
          .totalX = map_.total(0, row),
          .totalY = state.totalY.data(),
          .totalZ = totalZ_.data() + size_t(j) * nx};
}

}  // namespace raymap::cpu
