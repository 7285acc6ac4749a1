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

/// Sets `residual` to what the samples of `row` lack, but for the first and the last of the `count` samples.
void residualRow(const RowStencil& around, size_t count, const float* row, float* residual);

}  // namespace raymap::cpu
