#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kRadixBits = 8;  // Of the keys, sorted by in one pass.
RAYMAP_CONSTANT uint kRadixBins = 1 << kRadixBits;
RAYMAP_CONSTANT uint kRadixRows = 16;  // Elements of an invocation.

struct RadixSortPush {
  RAYMAP_ADDRESS(Uints) keys;
  RAYMAP_ADDRESS(Uints) values;
  RAYMAP_ADDRESS(Uints) sortedKeys;
  RAYMAP_ADDRESS(Uints) sortedValues;
  RAYMAP_ADDRESS(Uints) histogram;  // Of each bin, of each group: the count, or what comes before it.
  RAYMAP_ADDRESS(Uints) count;      // Where the number of elements lies; 0: it is `most`.
  uint most;
  uint word;  // The pass looks at these bits of this word of each key.
  uint shift;
  uint mask;
};
RAYMAP_CHECK_SIZE(RadixSortPush, 64);

RAYMAP_SHARED_END
