// Krayer & Müller 2019, §3.1, Fig. 2.

#include "cpu/cells/voxel_grid.h"

#include <raymap/error.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <string>

#include "base/memory.h"
#include "base/parallel.h"
#include "cpu/cells/cell_runs.h"

namespace raymap::cpu {

namespace {

constexpr size_t kTriangleGrain = 2048;
constexpr size_t kCellGrain = size_t{1} << 16;

/// Replaces each count, from index 1 on, by the sum of the counts before it. Returns the sum of all counts.
uint64_t prefixSum(Buffer<uint64_t>& starts) {
  const size_t blocks = (starts.size() - 1 + kCellGrain - 1) / kCellGrain;
  const auto block = [&](size_t b) {
    return std::span<uint64_t>(starts).subspan(1 + b * kCellGrain,
                                               std::min(kCellGrain, starts.size() - 1 - b * kCellGrain));
  };
  std::vector<uint64_t> sums(blocks + 1);
  parallelFor(blocks, 1, [&](size_t b, size_t) {
    const std::span<uint64_t> counts = block(b);
    sums[b] = std::accumulate(counts.begin(), counts.end(), uint64_t{0});
  });
  std::exclusive_scan(sums.begin(), sums.end(), sums.begin(), uint64_t{0});
  parallelFor(blocks, 1, [&](size_t b, size_t) {
    const std::span<uint64_t> counts = block(b);
    std::exclusive_scan(counts.begin(), counts.end(), counts.begin(), sums[b]);
  });
  return sums[blocks];
}

void checkListBytes(uint64_t entries, size_t maxListBytes) {
  if (entries <= maxListBytes / sizeof(uint32_t)) return;
  throw Error(ErrorCode::Memory, "the cells' triangle lists need " + neededText(entries * sizeof(uint32_t)) +
                                     ", but only " + limitText(maxListBytes) +
                                     " are left; use a lower resolution or exact distance");
}

}  // namespace

void buildVoxelGrid(const CellMesh& mesh, const CellLattice& cells, size_t maxListBytes, Progress& progress,
                    VoxelGrid& grid) {
  const size_t count = mesh.triangles.size();
  const auto forEachTriangle = [&](double start, auto&& work) {
    parallelFor(count, kTriangleGrain, [&](size_t begin, size_t end) {
      progress.report(start + 0.4 * double(begin) / double(count));
      size_t touched = 0;
      for (size_t t = begin; t < end; ++t) {
        forEachRun(mesh, cells, t, [&](size_t c, size_t last) {
          touched += last - c;
          for (; c < last; ++c) work(t, std::atomic_ref(grid.starts[c + 1]));
        });
        if (touched < kCellGrain) continue;
        progress.poll();  // Large triangles take long.
        touched = 0;
      }
    });
  };
  grid.cells = cells;
  grid.starts.resizeUninitialized(cells.count() + 1);
  parallelFor(grid.starts.size(), kCellGrain, [&](size_t begin, size_t end) {
    std::fill(grid.starts.data() + begin, grid.starts.data() + end, 0);
  });
  forEachTriangle(0.0, [](size_t, auto counter) { counter.fetch_add(1, std::memory_order_relaxed); });
  const uint64_t total = prefixSum(grid.starts);
  checkListBytes(total, maxListBytes);
  grid.triangles.resizeUninitialized(total);
  // Each start advances to the end of its cell's list, which is where the next cell's list starts.
  forEachTriangle(0.4, [&](size_t t, auto cursor) {
    grid.triangles[cursor.fetch_add(1, std::memory_order_relaxed)] = static_cast<uint32_t>(t);
  });
  // The threads filled the lists in an undefined order.
  parallelFor(cells.count(), kCellGrain, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c)
      std::sort(grid.triangles.data() + grid.starts[c], grid.triangles.data() + grid.starts[c + 1]);
  });
}

}  // namespace raymap::cpu
