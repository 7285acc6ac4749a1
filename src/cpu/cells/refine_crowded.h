#pragma once

#include "cpu/cells/voxel_grid.h"

namespace raymap::cpu {

/// Closest triangle so far; of equally close ones, the lowest.
struct Closest {
  float squared = INFINITY;
  uint32_t triangle = 0xffffffffu;

  void take(float candidate, uint32_t t) {
    if (candidate < squared || (candidate == squared && t < triangle)) *this = {candidate, t};
  }
};

/// Search trees over the triangles of crowded cells. With them a cell with a million triangles costs a sample
/// little more than one with ten (the paper's spike at low resolutions).
class CellTrees {
 public:
  /// Length of the longest list that is searched without a tree.
  static constexpr size_t kCrowd = 64;

  CellTrees(const CellMesh& mesh, const VoxelGrid& grid, Progress& progress);

  /// Updates `closest` with the triangles of a crowded cell.
  void search(size_t cell, const glm::vec3& p, Closest& closest) const;

 private:
  /// Disc around a leaf's triangles, from `back` to `front` along its normal. Around an oblique surface it is
  /// far tighter than a box, which decides how many triangles a far sample measures.
  struct Disc {
    glm::vec3 centre;
    glm::vec3 normal;
    float radius;
    float front;
    float back;

    /// Returns a conservative lower bound on the squared distance, reduced by the rounding error.
    float squaredDistance(const glm::vec3& p) const;
  };
  struct Node {
    glm::vec3 low{INFINITY};
    glm::vec3 high{-INFINITY};
    uint32_t begin;  ///< First of the node's triangles.
    uint32_t end;    ///< End of the node's triangles.
    uint32_t right;  ///< Second child, or 0 for a leaf. The first child is the next node.
    Disc disc{};     ///< Set for a leaf only.

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
