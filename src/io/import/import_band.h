#pragma once

#include <openvdb/openvdb.h>
#include <raymap/narrow_band.h>

#include <vector>

#include "io/import/import_stream.h"

namespace raymap {

/// Returns the box of the leaves that hold the active samples of a grid.
openvdb::CoordBBox leafBoxOf(const openvdb::CoordBBox& active);

/// Leaves and tiles of a level set, on a lattice that begins at the first sample of a leaf.
class BandShape {
 public:
  /// Throws `Error(Unsupported)` unless the grid is a level set.
  BandShape(const openvdb::FloatGrid& grid, const openvdb::CoordBBox& lattice);

  /// Fills in the counts and widths.
  void describe(VdbHeader& header) const;
  /// Writes leaves and tiles.
  void put() const;
  /// Writes the values of all leaves. Samples beyond the lattice have the background.
  template <class GridType>
  void putValues(const GridType& grid) const;

 private:
  void findInside(const openvdb::FloatGrid& grid);
  void add(const openvdb::FloatTree::LeafNodeType& leaf);
  void addTiles(const openvdb::FloatTree& tree);
  void addInside(const glm::ivec3& low, const glm::ivec3& end, int side);
  void addLeaves(const glm::ivec3& low, const glm::ivec3& end);
  bool isOnLattice(const glm::ivec3& sample) const;

  openvdb::Coord low_;
  glm::ivec3 dims_;
  float background_ = 0.0f, insideValue_ = 0.0f;
  double outside_ = 0.0, inside_ = 0.0;
  std::vector<glm::ivec3> leaves_;
  std::vector<NarrowBand::Tile> tiles_;
};

}  // namespace raymap
