#pragma once

#include "cpu/distance/surface_tree.h"

namespace raymap::cpu {

/// Input and output of a run, the same for every block.
struct ExactDistanceJob {
  const SurfaceTree& tree;
  glm::ivec3 dims;
  float band;       // cells; 0 = none
  float tolerance;  // cells; candidates that cannot be closer by more than this are dropped
  float* distance;
  uint32_t* triangle;  // may be null
  bool isAddition;     // keeps samples whose distance is already as small
};

}  // namespace raymap::cpu
