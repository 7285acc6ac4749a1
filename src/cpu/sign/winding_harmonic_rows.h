#pragma once

#include <cstddef>

namespace raymap::cpu {

/// Rows around a row of samples, and its right-hand side.
struct RowStencil {
  const float *jBefore, *jAfter, *kBefore, *kAfter;
  const float* rightHandSide;
};

/// Sets every second sample of `row` to the mean of the values that its six neighbours ask for. It starts at
/// `first`, which is 1 or 2, and stops before the last of the `count` samples.
void relaxRow(const RowStencil& around, size_t first, size_t count, float* row);

}  // namespace raymap::cpu
