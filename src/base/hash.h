#pragma once

#include <cstdint>
#include <string_view>

namespace raymap {

/// Returns a hash of bytes (FNV-1a). It finds damage, not malice.
constexpr uint64_t hashOf(std::string_view bytes) {
  uint64_t hash = 0xcbf29ce484222325;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  return hash;
}

/// Returns a hash of three numbers, as of a position's bits. Its upper half is mixed best.
constexpr uint64_t hashOf(uint64_t x, uint64_t y, uint64_t z) {
  const uint64_t ofTwo = ((x * 0x9E3779B97F4A7C15) ^ y) * 0xC2B2AE3D27D4EB4F;
  return (ofTwo ^ z) * 0x165667B19E3779F9;
}

}  // namespace raymap
