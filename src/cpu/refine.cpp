// Krayer & Müller 2019, §3.3, end.

#include "refine.h"

#include <algorithm>
#include <cmath>

#include "cell_trees.h"
#include "distance_transform.h"
#include "parallel.h"
#include "triangle.h"

namespace raymap {

namespace {

/// A ball around each triangle: what lies beyond the closest so far need not be measured.
struct Ball {
  glm::vec3 centre;
  float radius;
};

Buffer<Ball> makeBalls(const CellMesh& mesh) {
  Buffer<Ball> balls(mesh.triangles.size());
  parallelFor(balls.size(), 4096, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) {
      const glm::vec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
      const glm::vec3 centre = 0.5f * (glm::min(glm::min(a, b), c) + glm::max(glm::max(a, b), c));
      const float squared =
          std::max({squaredLength(a - centre), squaredLength(b - centre), squaredLength(c - centre)});
      // Larger by more than rounding, so that it can never hide the closest triangle.
      balls[t] = {centre, 1.0001f * std::sqrt(squared) + 1e-5f};
    }
  });
  return balls;
}

/// The triangles that belong to one nearest cell of one level.
class Candidates {
 public:
  Candidates(const CellMesh& mesh, std::span<const Ball> balls, const CellLevel& level,
             const CellTrees& trees, int reach)
      : mesh_(mesh), balls_(balls), level_(level), trees_(trees), reach_(reach) {}

  /// Takes the closest triangle of those that `sample`'s nearest cell and its neighbours list. A run of
  /// samples mostly has the same ones: the last sample's triangle is then a good start.
  void search(const glm::ivec3& sample, Closest& closest) {
    const CellLattice& cells = level_.grid.cells;
    const uint32_t nearest = level_.nearestCell[cells.index(CellPoint(cells, sample).cell)];
    if (nearest == kNoCell) return;
    const glm::vec3 p(sample);
    Closest own;
    if (nearest != nearest_) {
      collect(nearest);
    } else {
      own.take(squaredDistance(p, last_), last_);
    }
    for (const uint32_t cell : lists_) searchCell(cell, p, own);
    last_ = own.triangle;
    closest.take(own.squared, own.triangle);
  }

 private:
  void collect(uint32_t nearest) {
    const CellLattice& cells = level_.grid.cells;
    nearest_ = nearest;
    lists_.assign(1, nearest);
    const glm::ivec3 at = cells.cell(nearest);
    const glm::ivec3 low = glm::max(at - reach_, glm::ivec3(0));
    const glm::ivec3 high = glm::min(at + reach_, cells.dims - 1);
    for (int k = low.z; k <= high.z; ++k)
      for (int j = low.y; j <= high.y; ++j)
        for (int i = low.x; i <= high.x; ++i) {
          const auto cell = static_cast<uint32_t>(cells.index({i, j, k}));
          if (cell != nearest && !level_.grid.list(cell).empty()) lists_.push_back(cell);
        }
  }

  void searchCell(uint32_t cell, const glm::vec3& p, Closest& closest) const {
    const auto list = level_.grid.list(cell);
    if (list.size() > CellTrees::kCrowd) return trees_.search(cell, p, closest);
    float reach = std::sqrt(closest.squared);
    for (const uint32_t t : list) {
      const Ball& ball = balls_[t];
      const float far = reach + ball.radius;
      if (squaredLength(p - ball.centre) > far * far) continue;
      closest.take(squaredDistance(p, t), t);
      reach = std::sqrt(closest.squared);
    }
  }

  float squaredDistance(const glm::vec3& p, uint32_t t) const {
    return triangleSquaredDistance(p, mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2));
  }

  const CellMesh& mesh_;
  std::span<const Ball> balls_;
  const CellLevel& level_;
  const CellTrees& trees_;
  int reach_;
  uint32_t nearest_ = kNoCell;
  uint32_t last_ = 0;
  std::vector<uint32_t> lists_;
};

}  // namespace

void refineDistance(const CellMesh& mesh, std::span<const CellLevel> levels, int reach, Progress& progress,
                    Buffer<float>& distance, Buffer<uint32_t>& triangle) {
  const CellLattice samples{mesh.dims};
  const size_t rows = size_t(mesh.dims.y) * mesh.dims.z;
  const Buffer<Ball> balls = makeBalls(mesh);
  std::vector<CellTrees> trees;
  for (const CellLevel& level : levels) trees.emplace_back(mesh, level.grid, progress);
  distance.resize(samples.count());
  triangle.resize(samples.count());
  parallelFor(rows, 16, [&](size_t begin, size_t end) {
    progress.report(double(begin) / double(rows));
    std::vector<Candidates> candidates;
    for (size_t l = 0; l < levels.size(); ++l)
      candidates.emplace_back(mesh, balls, levels[l], trees[l], reach);
    for (size_t s = begin * mesh.dims.x; s < end * mesh.dims.x; ++s) {
      Closest closest;
      for (Candidates& level : candidates) level.search(samples.cell(s), closest);
      distance[s] = std::sqrt(closest.squared);
      triangle[s] = closest.triangle;
    }
  });
}

}  // namespace raymap
