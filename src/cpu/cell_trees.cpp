#include "cell_trees.h"

#include <algorithm>

#include "parallel.h"
#include "triangle.h"

namespace raymap {

namespace {
constexpr uint32_t kLeaf = 8;
// Bounds and distances round differently: what misses by less than this may still tie.
constexpr float kRounding = 0.99999f;

float doubledCentre(const CellMesh& mesh, uint32_t t, int axis) {
  const float a = mesh.corner(t, 0)[axis], b = mesh.corner(t, 1)[axis], c = mesh.corner(t, 2)[axis];
  return std::min({a, b, c}) + std::max({a, b, c});
}
}  // namespace

CellTrees::CellTrees(const CellMesh& mesh, const VoxelGrid& grid, Progress& progress) : mesh_(mesh) {
  for (size_t c = 0; c < grid.cells.count(); ++c) {
    const auto list = grid.list(c);
    if (list.size() > kCrowd) trees_.push_back({c, {list.begin(), list.end()}, {}});
  }
  parallelFor(trees_.size(), 1, [&](size_t begin, size_t end) {
    progress.report(0.0);
    for (size_t t = begin; t < end; ++t)
      build(trees_[t], 0, static_cast<uint32_t>(trees_[t].triangles.size()));
  });
}

float CellTrees::Node::squaredDistance(const glm::vec3& p) const {
  return squaredLength(glm::max(glm::vec3(0.0f), glm::max(low - p, p - high)));
}

void CellTrees::build(Tree& tree, uint32_t begin, uint32_t end) const {
  const size_t index = tree.nodes.size();
  Node node{.begin = begin, .end = end, .right = 0};
  for (uint32_t i = begin; i < end; ++i)
    for (int c = 0; c < 3; ++c) {
      node.low = glm::min(node.low, mesh_.corner(tree.triangles[i], c));
      node.high = glm::max(node.high, mesh_.corner(tree.triangles[i], c));
    }
  tree.nodes.push_back(node);
  if (end - begin <= kLeaf) return;
  const glm::vec3 size = node.high - node.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const uint32_t middle = begin + (end - begin) / 2;
  const auto first = tree.triangles.begin();
  std::nth_element(first + begin, first + middle, first + end, [&](uint32_t a, uint32_t b) {
    return doubledCentre(mesh_, a, axis) < doubledCentre(mesh_, b, axis);
  });
  build(tree, begin, middle);
  tree.nodes[index].right = static_cast<uint32_t>(tree.nodes.size());
  build(tree, middle, end);
}

void CellTrees::search(size_t cell, const glm::vec3& p, Closest& closest) const {
  const Tree& tree = *std::ranges::lower_bound(trees_, cell, {}, &Tree::cell);
  uint32_t stack[64];  // Halving 2^32 triangles takes at most 32 levels.
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const uint32_t index = stack[--depth];
    const Node& node = tree.nodes[index];
    if (kRounding * node.squaredDistance(p) > closest.squared) continue;
    if (node.right != 0) {
      const bool isLeftNearer =
          tree.nodes[index + 1].squaredDistance(p) <= tree.nodes[node.right].squaredDistance(p);
      stack[depth++] = isLeftNearer ? node.right : index + 1;
      stack[depth++] = isLeftNearer ? index + 1 : node.right;
      continue;
    }
    for (uint32_t i = node.begin; i < node.end; ++i) {
      const uint32_t t = tree.triangles[i];
      closest.take(triangleSquaredDistance(p, mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2)), t);
    }
  }
}

}  // namespace raymap
