#pragma once

#include <cstddef>

namespace raymap::cpu {

/// The rows around a row of samples, and its right-hand side.
struct RowStencil {
  const float *jBefore, *jAfter, *kBefore, *kAfter;
  const float* rightHandSide;
};

/// Sets every second sample of `row`, from `first` = 1 or 2 on, up to and not including the last one, to the
/// mean of what its six neighbours ask for.
void relaxRow(const RowStencil& around, size_t first, size_t count, float* row);

}  // namespace raymap::cpu
