#pragma once

#include "cpu/cells/voxel_grid.h"

namespace raymap::cpu {

/// Results of the stages before `refine`, for one of the lattices of `coverMesh`.
struct CellLevel {
  VoxelGrid grid;  ///< For `raster` only its lattice is set.
  Buffer<float> squared;
  Buffer<uint32_t> nearestCell;

  size_t bytes() const { return grid.bytes() + squared.capacityBytes() + nearestCell.capacityBytes(); }
  /// Returns the bytes over so many cells without the lists of triangles, which `raster` does not have.
  static size_t bytesNeeded(size_t cells) { return cells * (sizeof(float) + sizeof(uint32_t)); }
};

/// Position of a sample in a lattice, in units of its cells, and the cell that holds the sample.
struct CellPoint {
  glm::vec3 at;
  glm::ivec3 cell;

  CellPoint(const CellLattice& cells, const glm::ivec3& sample)
      : at((glm::dvec3(sample) - cells.first) / cells.size), cell(glm::floor(at + 0.5f)) {
    cell = glm::clamp(cell, glm::ivec3(0), cells.dims - 1);
  }
};

}  // namespace raymap::cpu
