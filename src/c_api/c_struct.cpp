#include "c_api/c_struct.h"

#include <raymap/version.h>

#include <algorithm>
#include <cstring>
#include <string>

namespace raymap::c {

namespace {

constexpr size_t kMostBytes = 1 << 16;  // More is memory that was not initialised.

/// Returns the size that a caller's struct states.
size_t statedSize(const void* given, size_t firstSize, const char* name) {
  size_t size = 0;
  std::memcpy(&size, given, sizeof size);
  if (size < firstSize || size > kMostBytes)
    throw Error(ErrorCode::Usage, "the size of a " + std::string(name) + " is " + std::to_string(size) +
                                      "; initialise it with RAYMAP_INIT(" + name +
                                      "), or set its member 'size' to its size in bytes");
  return size;
}

}  // namespace

void readStruct(const void* given, void* known, size_t knownSize, size_t firstSize, const char* name) {
  const size_t size = statedSize(given, firstSize, name);
  const auto* bytes = static_cast<const unsigned char*>(given);
  for (size_t b = knownSize; b < size; ++b)
    if (bytes[b] != 0)
      throw Error(ErrorCode::Usage, "byte " + std::to_string(b) + " of a " + name + " is not 0, but raymap " +
                                        version().text + " knows only its first " +
                                        std::to_string(knownSize) +
                                        " bytes; set newer members to 0, or use a newer library");
  std::memcpy(known, given, std::min(size, knownSize));
}

}  // namespace raymap::c
