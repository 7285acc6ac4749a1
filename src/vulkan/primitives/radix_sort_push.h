#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRadixBits = 8;  // Bits of the key sorted by in one pass.
RAYMAP_CONSTANT uint kRadixBins = 1 << kRadixBits;
RAYMAP_CONSTANT uint kRadixRows = 16;  // Elements per invocation.

struct RadixSortPush {
  RAYMAP_ADDRESS(Uints) keys;
  RAYMAP_ADDRESS(Uints) values;
  RAYMAP_ADDRESS(Uints) sortedKeys;
  RAYMAP_ADDRESS(Uints) sortedValues;
  RAYMAP_ADDRESS(Uints) histogram;  // Per bin and group: the count, then the sum before it.
  uint count;
  uint shift;
  uint mask;
  uint unused;
};
RAYMAP_CHECK_SIZE(RadixSortPush, 56);

RAYMAP_SHARED_END
