// Division of floats, rounded to nearest even like the CPU's. Devices may divide floats inexactly.

uint floatExponent(uint bits) {
  return (bits >> 23) & 0xffu;
}

// Returns the mantissa of a float that is not subnormal.
uint floatMantissa(uint bits) {
  return (bits & 0x7fffffu) | 0x800000u;
}

// Returns whether the float's size is at least 2^-125 and finite. Below, not all neighbours are normal floats.
bool isOrdinary(uint bits) {
  return floatExponent(bits) - 2u < 253u;
}

// Returns 1 or ~0u if the next larger or smaller float, by size, is closer to a / b than `quotient`, else 0. The quotient
// must be less than 32 units in the last place off. The arguments are bits of ordinary floats.
uint stepTowards(uint a, uint b, uint quotient) {
  const uint shift = 150u + floatExponent(a) - floatExponent(b) - floatExponent(quotient);
  const uint digits = floatMantissa(quotient);
  const int divisor = int(floatMantissa(b));
  const int rest = int((floatMantissa(a) << shift) - digits * uint(divisor));  // Fits, although the two do not.
  const int below = digits == 0x800000u ? 4 * rest : 2 * rest;  // Below a power of two, floats lie twice as close.
  return uint(2 * rest > divisor) - uint(below < -divisor);
}

// Returns the float nearest to a / b. Where one of the three is not ordinary, or b exceeds 2^126, the device rounds as it
// likes.
float divideRounded(float a, float b) {
  const uint aBits = floatBitsToUint(a), bBits = floatBitsToUint(b);
  uint quotient = floatBitsToUint(a / b);
  bool isDone = !isOrdinary(aBits) || !isOrdinary(bBits);
  while (!isDone) {
    const uint step = isOrdinary(quotient) ? stepTowards(aBits, bBits, quotient) : 0u;
    quotient += step;
    isDone = step == 0u;
  }
  return uintBitsToFloat(quotient);
}
