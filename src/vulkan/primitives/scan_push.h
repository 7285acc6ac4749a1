#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kScanGroup = 256;     // Invocations per work group.
RAYMAP_CONSTANT uint kScanRows = 4;        // Rows per work group; an invocation sums four elements in each.
RAYMAP_CONSTANT uint kScanBlockLog2 = 12;  // Elements per work group, log2.
RAYMAP_CONSTANT uint kScanBlock = 1 << kScanBlockLog2;

struct ScanPush {
  RAYMAP_ADDRESS(Uints) values;
  RAYMAP_ADDRESS(Uints) sums;       // The sum before each value, then the total.
  RAYMAP_ADDRESS(Uints) blockSums;  // Per block: its sum, or the sum before it. 0 for one block.
  uint count;
  uint areSummed;  // Whether `blockSums` has the sum before each block.
};
RAYMAP_CHECK_SIZE(ScanPush, 32);

RAYMAP_SHARED_END
