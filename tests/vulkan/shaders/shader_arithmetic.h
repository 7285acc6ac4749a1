#ifdef __cplusplus
#pragma once
#endif

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap::vulkan)

RAYMAP_CONSTANT uint kArithmeticResults = 8;

// For each pair of doubles: their sum, difference, product and quotient, the first one as a float, its floor
// and ceiling, and the rounded quotient of the floats in the lower words.
struct ShaderArithmeticPush {
  RAYMAP_ADDRESS(Uint64s) pairs;
  RAYMAP_ADDRESS(Uint64s) results;
  uint count;
  uint unused;
};
RAYMAP_CHECK_SIZE(ShaderArithmeticPush, 24);

RAYMAP_SHARED_END
