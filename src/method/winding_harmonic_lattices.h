#pragma once

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "method/winding_harmonic_shared.h"

namespace raymap {

/// Box of every 2^level-th sample of the grid's lattice; it may reach beyond the grid. Coordinate q lies at
/// sample q * 2^level. Values are stored from `low` on, x fastest.
struct LatticeBox {
  int level = 0;
  glm::ivec3 low{0};
  glm::ivec3 dims{0};

  size_t sampleCount() const { return size_t(dims.x) * size_t(dims.y) * size_t(dims.z); }
  /// Returns the number of samples in those of the planes [begin, end) across z that exist.
  size_t planeSamples(int begin, int end) const {
    return size_t(dims.x) * size_t(dims.y) * size_t(std::min(end, dims.z) - begin);
  }
  size_t row(int j, int k) const { return size_t(k) * size_t(dims.y) + size_t(j); }
  float* row(float* values, int j, int k) const { return values + row(j, k) * size_t(dims.x); }
  const float* row(const float* values, int j, int k) const { return values + row(j, k) * size_t(dims.x); }
};

// The lattices of the harmonic winding number, the same on every backend (docs/signs.md).

inline constexpr int kCoarsestSamples = 8;
inline constexpr int kCoarsestSweeps = 12;

/// Returns the lattice of a level.
inline LatticeBox harmonicBox(const glm::ivec3& dims, int level) {
  const auto whole = static_cast<uint>(level);
  return {.level = level, .low = glm::ivec3(harmonicLow(whole)), .dims = harmonicDims(dims, whole)};
}

/// Returns the level of the coarsest lattice, at least 2.
inline int coarsestHarmonicLevel(const glm::ivec3& dims) {
  int level = 2;
  while ((std::max({dims.x, dims.y, dims.z}) - 1) >> level >= kCoarsestSamples) ++level;
  return level;
}

/// Returns the best factor of successive over-relaxation (Young 1954) for a cube of the longest side.
inline float overrelaxation(const glm::ivec3& dims) {
  const int longest = std::max({dims.x, dims.y, dims.z});
  return static_cast<float>(2.0 / (1.0 + std::sin(std::numbers::pi / (longest - 1))));
}

}  // namespace raymap
