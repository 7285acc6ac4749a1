#pragma once

#include <cstdint>

namespace raymap {

/// Returns a / b, rounded up.
constexpr uint64_t ceilDiv(uint64_t a, uint64_t b) {
  return a / b + (a % b != 0 ? 1 : 0);
}

}  // namespace raymap
