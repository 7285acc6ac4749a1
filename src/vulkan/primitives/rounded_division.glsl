// Division of floats, rounded to nearest even like the CPU's. Devices may divide floats inexactly.

// Returns m / n * 2^23, rounded down, and in the lowest bit whether there is a rest; the quotient of the mantissas
// m and n must be at least 1 and below 2. `estimate` may be some 60 units in the last place off.
uint quotientBits(uint m, uint n, float estimate) {
  uint digits = uint(estimate * 8388608.0f);
  int rest = int((m << 23) - digits * n);  // Fits, although the two numbers do not.
  const int more = int(floor(float(rest) / float(n)));
  digits += uint(more);
  rest -= more * int(n);
  if (rest < 0) {
    rest += int(n);
    --digits;
  }
  if (rest >= int(n)) {
    rest -= int(n);
    ++digits;
  }
  // One bit more, and one for the rest.
  return digits * 4u + (2 * rest >= int(n) ? 2u : 0u) + uint(rest != 0 && 2 * rest != int(n));
}

// Mantissa of a float with its highest bit at 2^23, and its biased exponent, which is below 1 for subnormal floats.
struct ScaledFloat {
  uint mantissa;
  int exponent;
};

ScaledFloat scaledFloat(uint bits) {
  ScaledFloat scaled;
  scaled.exponent = int((bits >> 23) & 0xffu);
  scaled.mantissa = bits & 0x7fffffu;
  const int shift = scaled.exponent > 0 ? 0 : 23 - findMSB(scaled.mantissa);
  scaled.mantissa = scaled.exponent > 0 ? scaled.mantissa | 0x800000u : scaled.mantissa << shift;
  if (shift > 0) scaled.exponent = 1 - shift;
  return scaled;
}

// Returns the float nearest to bits / 4 * 2^(exponent - 150), where 2^25 <= bits < 2^26.
float packFloat(uint sign, int exponent, uint bits) {
  const int shift = 2 + clamp(1 - exponent, 0, 26);  // Below the least normal float, fewer bits remain.
  const uint dropped = bits & ((1u << shift) - 1u), middle = 1u << (shift - 1), kept = bits >> shift;
  const uint rounded = kept + uint(dropped > middle || (dropped == middle && (kept & 1u) != 0u));
  const uint result = (uint(max(exponent - 1, 0)) << 23) + rounded;
  return uintBitsToFloat(sign | (exponent < 255 ? result : 0x7f800000u));
}

float divideRounded(float a, float b) {
  const uint aBits = floatBitsToUint(a), bBits = floatBitsToUint(b);
  const uint sign = (aBits ^ bBits) & 0x80000000u, aSize = aBits & 0x7fffffffu, bSize = bBits & 0x7fffffffu;
  if (max(aSize, bSize) >= 0x7f800000u || bSize == 0u) return a / b;
  if (aSize == 0u) return uintBitsToFloat(sign);
  const ScaledFloat m = scaledFloat(aSize), n = scaledFloat(bSize);
  const uint doubled = uint(m.mantissa < n.mantissa);
  const uint mantissa = m.mantissa << doubled;
  const float estimate = float(mantissa) / float(n.mantissa);
  return packFloat(sign, m.exponent - n.exponent - int(doubled) + 127, quotientBits(mantissa, n.mantissa, estimate));
}
