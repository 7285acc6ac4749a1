#include "cpu/cells/refine_crowded.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "cpu/cells/triangle.h"

namespace raymap::cpu {

namespace {
constexpr uint32_t kLeaf = 8;
// Bounds and distances round differently, so a bound that is too large by less than this may still tie.
// `kBoxRounding` is a factor, `kDiscRounding` a share of the squared distance to a disc's centre.
constexpr float kBoxRounding = 0.99999f;
constexpr float kDiscRounding = 3e-6f;

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

float CellTrees::Disc::squaredDistance(const glm::vec3& p) const {
  const glm::vec3 q = p - centre;
  const float q2 = squaredLength(q), height = glm::dot(q, normal);
  const float over = std::max({0.0f, height - front, back - height});
  const float beside = std::max(0.0f, std::sqrt(std::max(0.0f, q2 - height * height)) - radius);
  return over * over + beside * beside - kDiscRounding * q2;
}

/// Returns the disc around triangles, across their mean normal. `centre` is the centre of their box.
CellTrees::Disc CellTrees::discAround(std::span<const uint32_t> triangles, const glm::vec3& centre) const {
  glm::vec3 normal(0.0f);
  for (const uint32_t t : triangles) {
    const glm::vec3 a = mesh_.corner(t, 0);
    normal += glm::cross(mesh_.corner(t, 1) - a, mesh_.corner(t, 2) - a);
  }
  const float length = glm::length(normal);
  normal = length > 1e-12f ? normal / length : glm::vec3(0.0f, 0.0f, 1.0f);
  float front = -INFINITY, back = INFINITY, radius2 = 0.0f, reach2 = 0.0f;
  for (const uint32_t t : triangles)
    for (int c = 0; c < 3; ++c) {
      const glm::vec3 q = mesh_.corner(t, c) - centre;
      const float q2 = squaredLength(q), height = glm::dot(q, normal);
      front = std::max(front, height);
      back = std::min(back, height);
      radius2 = std::max(radius2, q2 - height * height);
      reach2 = std::max(reach2, q2);
    }
  const float slack = kDiscRounding * std::sqrt(reach2);
  return {centre, normal, std::sqrt(radius2 + kDiscRounding * reach2), front + slack, back - slack};
}

void CellTrees::build(Tree& tree, uint32_t begin, uint32_t end) const {
  const size_t index = tree.nodes.size();
  Node node{.begin = begin, .end = end, .right = 0};
  for (uint32_t i = begin; i < end; ++i)
    for (int c = 0; c < 3; ++c) {
      node.low = glm::min(node.low, mesh_.corner(tree.triangles[i], c));
      node.high = glm::max(node.high, mesh_.corner(tree.triangles[i], c));
    }
  if (end - begin <= kLeaf)
    node.disc =
        discAround(std::span(tree.triangles).subspan(begin, end - begin), 0.5f * (node.low + node.high));
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
    if (kBoxRounding * node.squaredDistance(p) > closest.squared) continue;
    if (node.right != 0) {
      const bool isLeftNearer =
          tree.nodes[index + 1].squaredDistance(p) <= tree.nodes[node.right].squaredDistance(p);
      stack[depth++] = isLeftNearer ? node.right : index + 1;
      stack[depth++] = isLeftNearer ? index + 1 : node.right;
      continue;
    }
    if (node.disc.squaredDistance(p) > closest.squared) continue;
    for (uint32_t i = node.begin; i < node.end; ++i) {
      const uint32_t t = tree.triangles[i];
      closest.take(triangleSquaredDistance(p, mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2)), t);
    }
  }
}

}  // namespace raymap::cpu
