#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

/// Mixes all bits of a number (SplitMix64).
RAYMAP_FUNCTION uint64_t mixed(uint64_t v) {
  v = (v ^ v >> 30) * 0xbf58476d1ce4e5b9ul;
  v = (v ^ v >> 27) * 0x94d049bb133111ebul;
  return v ^ v >> 31;
}

/// Returns a hash of three numbers, as of a position's bits. Its upper half is mixed best.
RAYMAP_FUNCTION uint64_t hashOf(uint64_t x, uint64_t y, uint64_t z) {
  const uint64_t ofTwo = ((x * 0x9E3779B97F4A7C15ul) ^ y) * 0xC2B2AE3D27D4EB4Ful;
  return (ofTwo ^ z) * 0x165667B19E3779F9ul;
}

RAYMAP_SHARED_END
