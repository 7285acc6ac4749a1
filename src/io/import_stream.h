#pragma once

// What `raymap-import` writes to its standard output: this header, the message, the positions (three doubles
// each), then the triangles (three 32-bit indices each), in the machine's own byte order.

#include <cstdint>

namespace raymap {

inline constexpr uint32_t kImportMagic = 0x31494d52;  // RMI1

struct ImportHeader {
  uint32_t magic = kImportMagic;
  uint32_t failed = 0;  ///< The message then says why; otherwise it is a warning, or empty.
  uint64_t messageBytes = 0;
  uint64_t vertices = 0;
  uint64_t triangles = 0;
};
static_assert(sizeof(ImportHeader) == 32);

}  // namespace raymap
