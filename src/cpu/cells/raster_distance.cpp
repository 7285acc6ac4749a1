// Krayer & Müller 2019, §3.3, last paragraph.

#include "cpu/cells/raster_distance.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "cpu/cells/cell_distance.h"
#include "cpu/cells/cell_runs.h"
#include "cpu/cells/distance_transform.h"

namespace raymap::cpu {

namespace {

/// Lowers `target` to `value` atomically; the order of the threads does not matter. Paper: an atomic minimum
/// on integers, through a bijection from floats. Here: compare and exchange on the float itself, because
/// processors have that. If only integers have an atomic minimum, the bits of a non-negative float serve:
/// they have the same order.
void atomicMin(float& target, float value) {
  const std::atomic_ref<float> shared(target);
  float current = shared.load(std::memory_order_relaxed);
  while (value < current && !shared.compare_exchange_weak(current, value, std::memory_order_relaxed)) {
  }
}

/// Returns the squared distance at `p`, in cells. The transform's value in the cell of `p` holds for the
/// cell's centre, so the same parabola is evaluated at `p`.
float squaredDistance(const CellLevel& level, const CellPoint& p) {
  const CellLattice& cells = level.grid.cells;
  const size_t c = cells.index(p.cell);
  if (p.at == glm::vec3(p.cell)) return level.squared[c];
  const glm::vec3 nearest(cells.cell(level.nearestCell[c]));
  const float shift = squaredLength(p.at - nearest) - squaredLength(glm::vec3(p.cell) - nearest);
  return std::max(0.0f, level.squared[c] + shift);
}

}  // namespace

void rasterizeDistance(const CellMesh& mesh, const CellLattice& cells, Progress& progress,
                       Buffer<float>& squared) {
  constexpr size_t kGrain = 2048, kCellGrain = size_t{1} << 16;
  const size_t count = mesh.triangles.size();
  const auto perCell2 = static_cast<float>(1.0 / (cells.size * cells.size));
  squared.resizeUninitialized(cells.count());
  parallelFor(cells.count(), kCellGrain, [&](size_t begin, size_t end) {
    std::fill(squared.data() + begin, squared.data() + end, emptyCell(cells.dims));
  });
  parallelFor(count, kGrain, [&](size_t begin, size_t end) {
    progress.report(double(begin) / double(count));
    size_t touched = 0;
    for (size_t t = begin; t < end; ++t) {
      const glm::vec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
      forEachRun(mesh, cells, t, [&](size_t cell, size_t last) {
        touched += last - cell;
        for (; cell < last; ++cell)
          atomicMin(squared[cell],
                    perCell2 * triangleSquaredDistance(glm::vec3(cells.centre(cells.cell(cell))), a, b, c));
      });
      if (touched < kCellGrain) continue;
      progress.poll();  // Large triangles take long.
      touched = 0;
    }
  });
}

void sampleRasterDistance(glm::ivec3 dims, std::span<const CellLevel> levels, Progress& progress,
                          Buffer<float>& distance) {
  const size_t rows = size_t(dims.y) * dims.z;
  distance.resizeUninitialized(rows * dims.x);
  parallelFor(rows, 64, [&](size_t begin, size_t end) {
    progress.report(double(begin) / double(rows));
    for (size_t s = begin * dims.x; s < end * dims.x; ++s) {
      const glm::ivec3 sample = CellLattice{dims}.cell(s);
      distance[s] = INFINITY;
      for (const CellLevel& level : levels) {
        const CellPoint p(level.grid.cells, sample);
        if (level.nearestCell[level.grid.cells.index(p.cell)] == kNoCell) continue;
        distance[s] =
            std::min(distance[s], float(level.grid.cells.size) * std::sqrt(squaredDistance(level, p)));
      }
    }
  });
}

}  // namespace raymap::cpu
