#pragma once

#include "cpu/distance/surface_tree.h"

namespace raymap::cpu {

/// What a run reads and writes, the same for every block.
struct ExactDistanceJob {
  const SurfaceTree& tree;
  glm::ivec3 dims;
  float band;       // cells; 0 = none
  float tolerance;  // cells: candidates that cannot win by more are dropped
  float* distance;
  uint32_t* triangle;  // may be null
  bool isAddition;     // keeps what is as close already
};

}  // namespace raymap::cpu
