// Krayer & Müller 2019, §3.3, end.
//
// Paper: each sample by itself. Here: the samples of a block that have the same nearest cell go together,
// because they share their triangles. These are collected once, without duplicates, and measured from several
// samples at a time.

#include "cpu/cells/refine.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cpu/cells/closest_triangles.h"
#include "cpu/cells/distance_transform.h"
#include "cpu/cells/refine_crowded.h"

namespace raymap::cpu {

namespace {

constexpr int kSide = 8;
constexpr uint32_t kBlock = kSide * kSide * kSide;
static_assert(kBlock <= PointBatch::kCapacity);

class NearestCellRefiner {
 public:
  NearestCellRefiner(const CellMesh& mesh, std::span<const CellLevel> levels,
                     std::span<const CellTrees> trees, int reach)
      : mesh_(mesh), levels_(levels), trees_(trees), reach_(reach) {}

  void refine(const glm::ivec3& low, Buffer<float>& distance, Buffer<uint32_t>* triangle) {
    closest_.fill({});
    for (size_t l = 0; l < levels_.size(); ++l) refineLevel(l, low);
    forEachSample(low, [&](uint32_t i, const glm::ivec3& sample) {
      const size_t s = CellLattice{mesh_.dims}.index(sample);
      distance[s] = std::sqrt(closest_[i].squared);
      if (triangle) (*triangle)[s] = closest_[i].triangle;
    });
  }

 private:
  template <class Visit>
  void forEachSample(const glm::ivec3& low, Visit&& visit) const {
    const glm::ivec3 size = glm::min(mesh_.dims - low, glm::ivec3(kSide));
    for (int k = 0; k < size.z; ++k)
      for (int j = 0; j < size.y; ++j)
        for (int i = 0; i < size.x; ++i)
          visit(static_cast<uint32_t>((k * kSide + j) * kSide + i), low + glm::ivec3(i, j, k));
  }

  void refineLevel(size_t l, const glm::ivec3& low) {
    const CellLevel& level = levels_[l];
    const CellLattice& cells = level.grid.cells;
    byCell_.clear();
    forEachSample(low, [&](uint32_t i, const glm::ivec3& sample) {
      const uint32_t nearest = level.nearestCell[cells.index(CellPoint(cells, sample).cell)];
      if (nearest != kNoCell) byCell_.push_back(uint64_t{nearest} * kBlock + i);
    });
    std::sort(byCell_.begin(), byCell_.end());
    for (size_t begin = 0, end = 0; begin < byCell_.size(); begin = end) {
      const uint64_t nearest = byCell_[begin] / kBlock;
      while (end < byCell_.size() && byCell_[end] / kBlock == nearest) ++end;
      collect(level.grid, cells.cell(nearest));
      measure(trees_[l], low, {byCell_.data() + begin, end - begin});
    }
  }

  /// Collects the triangles of a nearest cell and its neighbours, in ascending order. Crowded cells are only
  /// listed.
  void collect(const VoxelGrid& grid, const glm::ivec3& nearest) {
    candidates_.clear();
    crowded_.clear();
    const glm::ivec3 low = glm::max(nearest - reach_, glm::ivec3(0));
    const glm::ivec3 high = glm::min(nearest + reach_, grid.cells.dims - 1);
    for (int k = low.z; k <= high.z; ++k)
      for (int j = low.y; j <= high.y; ++j)
        for (int i = low.x; i <= high.x; ++i) {
          const size_t cell = grid.cells.index({i, j, k});
          const auto list = grid.list(cell);
          if (list.size() > CellTrees::kCrowd) {
            crowded_.push_back(cell);
          } else {
            candidates_.insert(candidates_.end(), list.begin(), list.end());
          }
        }
    if (reach_ == 0) return;
    std::sort(candidates_.begin(), candidates_.end());
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
  }

  void measure(const CellTrees& trees, const glm::ivec3& low, std::span<const uint64_t> samples) {
    batch_.count = samples.size();
    for (size_t n = 0; n < samples.size(); ++n) {
      const glm::ivec3 sample = low + CellLattice{glm::ivec3(kSide)}.cell(samples[n] % kBlock);
      batch_.x[n] = static_cast<float>(sample.x);
      batch_.y[n] = static_cast<float>(sample.y);
      batch_.z[n] = static_cast<float>(sample.z);
      batch_.squared[n] = INFINITY;
      batch_.triangle[n] = Closest().triangle;
    }
    findClosestTriangles(mesh_, candidates_, batch_);
    for (size_t n = 0; n < samples.size(); ++n) {
      Closest own{batch_.squared[n], batch_.triangle[n]};
      for (const size_t cell : crowded_) trees.search(cell, {batch_.x[n], batch_.y[n], batch_.z[n]}, own);
      closest_[samples[n] % kBlock].take(own.squared, own.triangle);
    }
  }

  const CellMesh& mesh_;
  std::span<const CellLevel> levels_;
  std::span<const CellTrees> trees_;
  int reach_;
  std::array<Closest, kBlock> closest_;
  std::vector<uint64_t> byCell_;  ///< Nearest cell * kBlock + index in the block.
  std::vector<uint32_t> candidates_;
  std::vector<size_t> crowded_;
  PointBatch batch_;
};

}  // namespace

void refineDistance(const CellMesh& mesh, std::span<const CellLevel> levels, int reach, Progress& progress,
                    Buffer<float>& distance, Buffer<uint32_t>* triangle) {
  constexpr size_t kBlocksAtOnce = 16;
  const CellLattice blocks{(mesh.dims + kSide - 1) / kSide};
  std::vector<CellTrees> trees;
  for (const CellLevel& level : levels) trees.emplace_back(mesh, level.grid, progress);
  distance.resizeUninitialized(CellLattice{mesh.dims}.count());
  if (triangle) triangle->resizeUninitialized(distance.size());
  parallelFor(blocks.count(), kBlocksAtOnce, [&](size_t begin, size_t end) {
    NearestCellRefiner refiner(mesh, levels, trees, reach);
    for (size_t b = begin; b < end; ++b) {
      progress.report(double(b) / double(blocks.count()));
      refiner.refine(kSide * blocks.cell(b), distance, triangle);
    }
  });
}

}  // namespace raymap::cpu
