#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <glm/glm.hpp>

#include "base/hash_shared.h"

namespace raymap {

/// A position as bits, equal exactly where the coordinates are: -0 equals 0, and even NaN is ordered.
using PositionBits = std::array<uint32_t, 3>;

inline PositionBits positionBits(const glm::vec3& position) {
  const glm::vec3 p = position + 0.0f;  // Turns -0 into 0.
  return {std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y), std::bit_cast<uint32_t>(p.z)};
}

/// Returns a hash that equal positions share. Its upper half is mixed best.
inline uint64_t hashOf(const glm::vec3& position) {
  const PositionBits bits = positionBits(position);
  return hashOf(bits[0], bits[1], bits[2]);
}

}  // namespace raymap
