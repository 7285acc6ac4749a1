#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mesh/double_sided.h"
#include "method/cell_mesh.h"

namespace raymap::cpu {

/// Number of triangles or discs in a packet, one per lane. Either all are read at once, or one is spread over
/// all lanes.
inline constexpr uint32_t kPacket = 8;

/// Eight triangles, each in its own frame: corner a is the origin, b = (bx, 0), c = (cx, cy) with cy >= 0. In
/// this form the distance to a point needs no division.
struct alignas(64) TrianglePacket {
  float ax[kPacket], ay[kPacket], az[kPacket];  ///< Corner a.
  float xx[kPacket], xy[kPacket], xz[kPacket];  ///< Axis x, along ab.
  float yx[kPacket], yy[kPacket], yz[kPacket];  ///< Axis y.
  float zx[kPacket], zy[kPacket], zz[kPacket];  ///< Axis z, the normal.
  float bx[kPacket], cx[kPacket], cy[kPacket];
  float inverseBc2[kPacket], inverseCa2[kPacket];  ///< 1 / |c - b|^2 and 1 / |a - c|^2; 0 for length 0.
  uint32_t id[kPacket];                            ///< Index in the mesh.
};

/// Eight discs with thickness. Far samples see a surface in them, which they would not in balls.
struct alignas(64) DiscPacket {
  float cx[kPacket], cy[kPacket], cz[kPacket];  ///< Centre.
  float nx[kPacket], ny[kPacket], nz[kPacket];  ///< Unit normal.
  float radius[kPacket], halfThickness[kPacket];
};

class PlaceLattice;

/// Whether a tree stores the frames of its triangles. Made frames equal stored ones to the last bit.
enum class Frames {
  Stored,  ///< In memory: 72 bytes per triangle.
  Made     ///< Made of the mesh that was given when a leaf is read. Its arrays must outlive the tree.
};

/// Tree over the triangles in the order of a space-filling curve, eight to a leaf. A node is a disc around a
/// leaf or around eight nodes of the level below. There are no pointers: the position of a node's children
/// follows from its index.
class SurfaceTree {
 public:
  /// Nodes of a level: `count` of them from `start` on, which begins a packet. The leaves are level 0.
  struct Level {
    uint32_t start, count;
  };

  void build(const CellMesh& mesh, Frames frames = Frames::Stored);
  /// Builds the tree of one face, the first, of each group of double-sided faces and of all other faces.
  /// Returns the groups.
  DoubleSidedFaces buildSingleSided(const CellMesh& mesh, Frames frames = Frames::Stored);
  /// Reverses the normals of the mesh's faces, or sets them to 0 where faces are left out (`Turns`).
  /// Distances of the tree are wrong afterwards if any is. An empty span changes none.
  void turn(std::span<const uint8_t> turns);

  const DiscPacket& discs(uint32_t packet) const { return discs_[packet]; }
  /// Returns the triangles of a leaf. If they are made, they stay until the thread reads another leaf.
  const TrianglePacket& triangles(uint32_t packet) const {
    return frames_ == Frames::Stored ? triangles_[packet] : made(packet);
  }
  /// Returns the memory that `triangles` will read first.
  std::span<const std::byte> memoryOf(uint32_t packet) const {
    if (frames_ == Frames::Stored) return std::as_bytes(std::span(&triangles_[packet], 1));
    return std::as_bytes(std::span(&ids_[packet * kPacket], kPacket));
  }
  float radius(uint32_t node) const { return discs_[node / kPacket].radius[node % kPacket]; }
  /// Returns the index in the mesh of the tree's triangle `t`; each leaf has eight.
  uint32_t triangleId(uint32_t t) const {
    return frames_ == Frames::Stored ? triangles_[t / kPacket].id[t % kPacket] : ids_[t];
  }

  Frames frames() const { return frames_; }
  uint32_t triangleCount() const { return triangleCount_; }
  std::span<const Level> levels() const { return levels_; }
  uint32_t leafCount() const { return levels_[0].count; }
  uint32_t root() const { return levels_.back().start; }
  /// Returns whether a node's children are a packet of triangles. Any other node's are a packet of nodes.
  bool isLeaf(uint32_t node) const { return node < leafCount(); }
  /// Returns the packet of a node's children. The last packet of a level may be filled up with a repeated
  /// triangle or with discs out of reach.
  uint32_t childPacket(uint32_t node) const { return childPacket(node, levelOf(node)); }
  /// Returns the same for a node of this level, without a search for it.
  uint32_t childPacket(uint32_t node, uint32_t level) const {
    return level == 0 ? node : levels_[level - 1].start / kPacket + (node - levels_[level].start);
  }
  /// Returns the level of a node; that of the leaves is 0.
  uint32_t levelOf(uint32_t node) const;
  /// Frees what only builds need. With made frames, a build does so itself.
  void releaseScratch() { keys_.release(); }
  size_t bytes() const;
  /// Returns the bytes that the build of a tree over so many triangles takes.
  static size_t bytesNeeded(size_t triangles, Frames frames = Frames::Stored);

 private:
  std::vector<uint64_t> sortTriangles(const CellMesh& mesh, const PlaceLattice& lattice);
  void removeTriangles(std::span<const uint32_t> triangles, size_t meshTriangles);
  const TrianglePacket& made(uint32_t leaf) const;
  void start(const CellMesh& mesh, Frames frames);
  void changeVersion();
  void buildNodes(const CellMesh& mesh, const PlaceLattice& lattice);
  void placeLevels();
  void buildLeaves(const CellMesh& mesh, const PlaceLattice& lattice);
  void buildLeaf(const CellMesh& mesh, uint32_t leaf);
  void buildLevel(uint32_t level);

  Buffer<uint64_t> keys_;  // Of a build: the triangle in the lower half; numbers to sort by above it.
  Frames frames_ = Frames::Stored;
  Buffer<TrianglePacket> triangles_;  // By leaf, if they are stored.
  // If frames are made: the mesh, its conversion, and the triangles and turns of the leaves.
  PackedMesh given_;
  CellUnits units_;
  Buffer<uint32_t> ids_;        // Index in the mesh of each of the tree's triangles.
  std::vector<uint8_t> turns_;  // Empty: all as given.
  uint64_t version_ = 0;        // No two trees have the same, nor one tree before and after a change.

  Buffer<DiscPacket> discs_;
  std::vector<Level> levels_;
  uint32_t triangleCount_ = 0;
};

}  // namespace raymap::cpu
