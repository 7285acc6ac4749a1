#pragma once

#include <span>
#include <vector>

#include "method/cell_mesh.h"

namespace raymap::cpu {

/// Triangles and discs are kept eight to a packet, one value per lane: either all are read at once, or one is
/// spread over all lanes.
inline constexpr uint32_t kPacket = 8;

/// Eight triangles, each in a frame of its own: corner a is the origin, b = (bx, 0), c = (cx, cy) with cy >=
/// 0. Written so that the distance to a point needs no division.
struct alignas(64) TrianglePacket {
  float ax[kPacket], ay[kPacket], az[kPacket];  ///< Corner a.
  float xx[kPacket], xy[kPacket], xz[kPacket];  ///< Axis x, along ab,
  float yx[kPacket], yy[kPacket], yz[kPacket];  ///< y,
  float zx[kPacket], zy[kPacket], zz[kPacket];  ///< and the normal.
  float bx[kPacket], cx[kPacket], cy[kPacket];
  float inverseBc2[kPacket], inverseCa2[kPacket];  ///< 1 / |c - b|^2 and 1 / |a - c|^2; 0 without length.
};

/// Eight discs with thickness: far samples see a surface, not balls.
struct alignas(64) DiscPacket {
  float cx[kPacket], cy[kPacket], cz[kPacket];  ///< Centre.
  float nx[kPacket], ny[kPacket], nz[kPacket];  ///< Unit normal.
  float radius[kPacket], halfThickness[kPacket];
};

class PlaceLattice;

/// The triangles in the order of a space-filling curve, eight to a leaf, and discs around leaves and around
/// eight nodes each of the level below. No pointers: where a node's children lie follows from its index.
class SurfaceTree {
 public:
  /// The nodes of a level, leaves first: `count` of them from `start` on, which begins a packet.
  struct Level {
    uint32_t start, count;
  };

  void build(const CellMesh& mesh);
  /// Turns the normals of some faces of the mesh, those with a 1; none are where it is empty.
  void turn(std::span<const uint8_t> faces);

  const DiscPacket& discs(uint32_t packet) const { return discs_[packet]; }
  const TrianglePacket& triangles(uint32_t packet) const { return triangles_[packet]; }
  float radius(uint32_t node) const { return discs_[node / kPacket].radius[node % kPacket]; }
  /// The index in the mesh of a triangle of a leaf, 8 to a leaf.
  uint32_t triangleId(uint32_t t) const { return static_cast<uint32_t>(keys_[t]); }

  uint32_t triangleCount() const { return triangleCount_; }
  std::span<const Level> levels() const { return levels_; }
  uint32_t leafCount() const { return levels_[0].count; }
  uint32_t root() const { return levels_.back().start; }
  /// A leaf's children are a packet of triangles, any other node's a packet of nodes.
  bool isLeaf(uint32_t node) const { return node < leafCount(); }
  /// The packet of a node's children. The last of a level may be filled up, with a triangle again or with
  /// discs out of reach.
  uint32_t childPacket(uint32_t node) const;
  size_t bytes() const;

 private:
  void placeLevels();
  void sortTriangles(const CellMesh& mesh, const PlaceLattice& lattice);
  void buildLeaves(const CellMesh& mesh, const PlaceLattice& lattice);
  void buildLevel(uint32_t level);

  Buffer<uint64_t> keys_;  // curve position << 32 | triangle
  Buffer<TrianglePacket> triangles_;
  Buffer<DiscPacket> discs_;
  std::vector<Level> levels_;
  uint32_t triangleCount_ = 0;
};

}  // namespace raymap::cpu
