// Unsigned integers with the same order as floats.

uint toOrdered(float value) {
  const uint bits = floatBitsToUint(value);
  return bits ^ (uint(int(bits) >> 31) | 0x80000000u);
}

float fromOrdered(uint ordered) {
  return uintBitsToFloat(ordered ^ (((ordered >> 31) - 1) | 0x80000000u));
}
