#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kScanGroup = 256;     // Invocations of a work group,
RAYMAP_CONSTANT uint kScanRows = 4;        // each of which sums four elements in each of these rows.
RAYMAP_CONSTANT uint kScanBlockLog2 = 12;  // Elements of a work group.
RAYMAP_CONSTANT uint kScanBlock = 1 << kScanBlockLog2;

struct ScanPush {
  RAYMAP_ADDRESS(Uints) values;
  RAYMAP_ADDRESS(Uints) sums;  // What comes before each value, and after the last the total.
  RAYMAP_ADDRESS(Uints)
  blockSums;                    // Of each block: its sum, or what comes before it. 0 if there is one block.
  RAYMAP_ADDRESS(Uints) count;  // Where the number of elements of the first level lies; 0: it is `most`.
  uint most;
  uint levelLog2;  // How many elements of the first level a value stands for.
};
RAYMAP_CHECK_SIZE(ScanPush, 40);

RAYMAP_SHARED_END
