#pragma once

#include "cpu/cells/voxel_grid.h"

namespace raymap::cpu {

/// Results of the stages before `refine`, for one of the lattices of `coverMesh`.
struct CellLevel {
  VoxelGrid grid;  ///< For `raster` only its lattice is set.
  Buffer<float> squared;
  Buffer<uint32_t> nearestCell;
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
