#pragma once

#include <cstdint>

namespace raymap {

/// Spreads the lowest 21 bits of a number, so that two zeros follow each: a coordinate of a Morton code.
constexpr uint64_t spreadBits(uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

/// Returns the place of a cell on a space-filling curve, x lowest.
constexpr uint64_t mortonCode(uint64_t x, uint64_t y, uint64_t z) {
  return spreadBits(x) | spreadBits(y) << 1 | spreadBits(z) << 2;
}

}  // namespace raymap
