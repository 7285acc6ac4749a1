#include "vulkan/device/kernel.glsl"
#include "vulkan/primitives/rounded_division.glsl"
#include "vulkan/primitives/soft_double.glsl"

#include "shader_arithmetic.h"

layout(push_constant, scalar) uniform Push { ShaderArithmeticPush push; };

void main() {
  const uint i = invocationIndex();
  if (i >= push.count) return;
  const Double a = push.pairs.at[2 * i], b = push.pairs.at[2 * i + 1];
  const uint to = kArithmeticResults * i;
  push.results.at[to] = sum(a, b);
  push.results.at[to + 1] = difference(a, b);
  push.results.at[to + 2] = product(a, b);
  push.results.at[to + 3] = quotient(a, b);
  push.results.at[to + 4] = uint64_t(floatBitsToUint(floatOf(a)));
  push.results.at[to + 5] = uint64_t(uint(floorOf(a)));
  push.results.at[to + 6] = uint64_t(uint(ceilOf(a)));
  const float quotientOfFloats = divideRounded(uintBitsToFloat(uint(a)), uintBitsToFloat(uint(b)));
  push.results.at[to + 7] = uint64_t(floatBitsToUint(quotientOfFloats));
}
