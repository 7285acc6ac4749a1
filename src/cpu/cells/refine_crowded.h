#pragma once

#include "cpu/cells/voxel_grid.h"

namespace raymap::cpu {

/// The closest triangle so far; of equally close ones the lowest.
struct Closest {
  float squared = INFINITY;
  uint32_t triangle = 0xffffffffu;

  void take(float candidate, uint32_t t) {
    if (candidate < squared || (candidate == squared && t < triangle)) *this = {candidate, t};
  }
};

/// Search trees over the triangles of crowded cells, so that a cell with a million triangles costs a sample
/// little more than one with ten (the paper's spike at low resolutions).
class CellTrees {
 public:
  /// Lists up to this long are searched as they are.
  static constexpr size_t kCrowd = 64;

  CellTrees(const CellMesh& mesh, const VoxelGrid& grid, Progress& progress);

  /// Takes every triangle of a crowded cell that can be as close to p as `closest`.
  void search(size_t cell, const glm::vec3& p, Closest& closest) const;

 private:
  /// Around a leaf's triangles, from `back` to `front` along its normal: far tighter than a box where a
  /// surface runs askew, which decides how many are looked at from far away.
  struct Disc {
    glm::vec3 centre;
    glm::vec3 normal;
    float radius;
    float front;
    float back;

    /// Of the closest point that there may be, less what distances are rounded by.
    float squaredDistance(const glm::vec3& p) const;
  };
  struct Node {
    glm::vec3 low{INFINITY};
    glm::vec3 high{-INFINITY};
    uint32_t begin;
    uint32_t end;    ///< Of the leaf's triangles;
    uint32_t right;  ///< or, if not 0, the second child, the first comes next.
    Disc disc{};     ///< Of a leaf.

    float squaredDistance(const glm::vec3& p) const;
  };
  struct Tree {
    size_t cell;
    std::vector<uint32_t> triangles;
    std::vector<Node> nodes;
  };

  Disc discAround(std::span<const uint32_t> triangles, const glm::vec3& centre) const;
  void build(Tree& tree, uint32_t begin, uint32_t end) const;

  const CellMesh& mesh_;
  std::vector<Tree> trees_;
};

}  // namespace raymap::cpu
