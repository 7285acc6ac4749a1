// Writes two distances per invocation as half floats, rounded to the nearest, ties to even. None becomes
// infinite. The rounding is explicit because those of packHalf2x16 and roundEven depend on the device.
#include "vulkan/device/kernel.glsl"
#include "vulkan/stages/field_image_push.h"

layout(push_constant, scalar) uniform Push { HalfFloatsPush push; };

uint halfOf(float value) {
  const uint bits = floatBitsToUint(value), sign = bits >> 16 & 0x8000u, size = bits & 0x7fffffffu;
  if (size >= 0x477ff000u) return sign | 0x7bffu;  // 65520 and more would round to infinity.
  if (size < 0x38800000u) {  // Below 2^-14: a multiple of 2^-24, the spacing of floats from 0.5 on.
    precise const float sum = uintBitsToFloat(size) + 0.5;
    return sign | (floatBitsToUint(sum) - floatBitsToUint(0.5));
  }
  const uint shifted = size - 0x38000000u;  // Exponent bias: 15 instead of 127.
  return sign | (shifted + 0xfffu + (shifted >> 13 & 1u)) >> 13;
}

void main() {
  const uint pair = invocationIndex();
  if (2 * pair >= push.count) return;
  const uint low = halfOf(push.values.at[2 * pair]);
  const uint high = 2 * pair + 1 < push.count ? halfOf(push.values.at[2 * pair + 1]) : 0;
  push.halves.at[pair] = high << 16 | low;
}
