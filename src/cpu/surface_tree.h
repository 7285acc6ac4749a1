#pragma once

#include "cell_mesh.h"

#include <vector>

namespace raymap {

/// A triangle in a frame of its own: corner a is the origin, b = (bx, 0), c = (cx, cy) with cy >= 0. Written
/// so that the distance to a point needs no division.
struct FramedTriangle {
  glm::vec3 a, x, y, z;  ///< Origin and orthonormal axes; z is the normal.
  float bx, cx, cy;
  float inverseBc2, inverseCa2;  ///< 1 / |c - b|^2 and 1 / |a - c|^2; 0 for an edge without length.
  uint32_t id;                   ///< Index in the mesh.
};

/// A disc with thickness, around everything below a node: far samples see a surface, not balls.
struct Disc {
  glm::vec3 centre;
  glm::vec3 normal;
  float radius;
  float halfThickness;
};

/// The triangles in the order of a space-filling curve, and discs around runs of them: node n of level 0
/// bounds triangles [n * kLeafSize, (n + 1) * kLeafSize), node n of level l + 1 the nodes [n * kArity, (n +
/// 1) * kArity) of level l. No pointers: where a node's children lie follows from its index.
class SurfaceTree {
 public:
  static constexpr uint32_t kLeafSize = 4;
  static constexpr uint32_t kArity = 4;

  /// A run of node indices or of triangles.
  struct Range {
    uint32_t begin, end;
  };

  void build(const CellMesh& mesh);

  const Disc& disc(uint32_t node) const { return discs_[node]; }
  const FramedTriangle& triangle(uint32_t t) const { return triangles_[t]; }
  uint32_t root() const { return static_cast<uint32_t>(discs_.size()) - 1; }
  bool isLeaf(uint32_t node) const { return node < levelStarts_[1]; }
  /// The triangles of a leaf, or the child nodes of any other node.
  Range children(uint32_t node) const;
  /// One of the triangles below the node, near its middle.
  uint32_t representative(uint32_t node) const;
  size_t bytes() const;

 private:
  void sortTriangles(const CellMesh& mesh);
  void buildDiscs(const CellMesh& mesh);
  uint32_t level(uint32_t node) const;

  Buffer<uint64_t> keys_;  // curve position << 32 | triangle
  Buffer<FramedTriangle> triangles_;
  Buffer<Disc> discs_;
  std::vector<uint32_t> levelStarts_;  // first node of each level, then the number of nodes
};

}  // namespace raymap
