#pragma once

#include <cstdint>
#include <string_view>

#include "base/hash_shared.h"

namespace raymap {

/// Returns a hash of bytes (FNV-1a). It finds damage, not malice.
constexpr uint64_t hashOf(std::string_view bytes) {
  uint64_t hash = 0xcbf29ce484222325;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  return hash;
}

}  // namespace raymap
