// Double-precision numbers as 64-bit integers, for devices without them: IEEE 754 binary64, rounded to nearest
// even like the CPU's. Operands must be finite. Numbers below the least normal one are taken as 0. A result that is
// too large is infinite.

#define Double uint64_t

const uint64_t kDoubleSign = 0x8000000000000000ul;
const uint64_t kDoubleMantissa = 0xffffffffffffful;
const int kDoubleBias = 1023;
const uint64_t kHalf = 0x3fe0000000000000ul;

int exponentBits(Double a) {
  return int(uint(a >> 52) & 0x7ffu);
}

// Returns the mantissa with its leading 1.
uint64_t mantissaOf(Double a) {
  return exponentBits(a) == 0 ? 0ul : (a & kDoubleMantissa) | (kDoubleMantissa + 1ul);
}

int highestBit(uint64_t a) {
  const uint high = uint(a >> 32);
  return high != 0u ? 32 + findMSB(high) : findMSB(uint(a));
}

// Returns the double nearest to mantissa * 2^(exponent - 62), where 0 < mantissa < 2^63. The lowest bit may stand for
// any number of bits below it, if it is 1 where one of those is.
Double packDouble(uint64_t sign, int exponent, uint64_t mantissa) {
  const int shift = 62 - highestBit(mantissa);
  const int biased = exponent - shift + kDoubleBias;
  const uint64_t shifted = mantissa << shift;
  const uint64_t rounded = (shifted + 511ul + ((shifted >> 10) & 1ul)) >> 10;
  const uint64_t bits = (uint64_t(uint(max(biased - 1, 0))) << 52) + rounded;
  if (biased <= 0) return sign;
  return sign | (bits < 0x7ff0000000000000ul ? bits : 0x7ff0000000000000ul);
}

Double doubleOf(int a) {
  const uint64_t sign = a < 0 ? kDoubleSign : 0ul;
  return a == 0 ? 0ul : packDouble(sign, 62, uint64_t(uint(abs(a))));
}

Double doubleOf(float a) {
  const uint bits = floatBitsToUint(a), mantissa = bits & 0x7fffffu;
  const int biased = int((bits >> 23) & 0xffu);
  const uint64_t sign = uint64_t(bits & 0x80000000u) << 32;
  if (biased != 0) return sign | (uint64_t(uint(biased - 127 + kDoubleBias)) << 52) | (uint64_t(mantissa) << 29);
  return mantissa == 0u ? sign : packDouble(sign, 62 - 149, uint64_t(mantissa));
}

// Returns the nearest float.
float floatOf(Double a) {
  const uint sign = uint(a >> 32) & 0x80000000u;
  const int biased = exponentBits(a) - kDoubleBias + 127;
  const int shift = 29 + clamp(1 - biased, 0, 30);  // Below the least normal float, fewer bits remain.
  const uint64_t mantissa = mantissaOf(a);
  const uint64_t middle = 1ul << (shift - 1);
  const uint rounded = uint((mantissa + (middle - 1ul) + ((mantissa >> shift) & 1ul)) >> shift);
  const uint bits = (uint(max(biased - 1, 0)) << 23) + rounded;
  return uintBitsToFloat(sign | (biased < 255 ? bits : 0x7f800000u));
}

Double negative(Double a) {
  return a ^ kDoubleSign;
}

Double absolute(Double a) {
  return a & ~kDoubleSign;
}

// The result must be in the range of normal numbers.
Double timesPowerOfTwo(Double a, int exponent) {
  return absolute(a) == 0ul ? a : a + (uint64_t(int64_t(exponent)) << 52);
}

Double sum(Double a, Double b) {
  const bool isAFirst = absolute(a) >= absolute(b);
  const Double large = isAFirst ? a : b, small = isAFirst ? b : a;
  const int apart = min(exponentBits(large) - exponentBits(small), 62);
  const uint64_t m = mantissaOf(large) << 9, n = mantissaOf(small) << 9;
  const uint64_t aligned = (n >> apart) | uint64_t(uint((n & ((1ul << apart) - 1ul)) != 0ul));
  const uint64_t total = ((a ^ b) & kDoubleSign) != 0ul ? m - aligned : m + aligned;
  if (total == 0ul) return a & b & kDoubleSign;
  return packDouble(large & kDoubleSign, exponentBits(large) - kDoubleBias + 1, total);
}

Double difference(Double a, Double b) {
  return sum(a, negative(b));
}

Double product(Double a, Double b) {
  const uint64_t sign = (a ^ b) & kDoubleSign;
  const uint64_t m = mantissaOf(a) << 11, n = mantissaOf(b) << 10;
  const uint64_t mLow = uint64_t(uint(m)), mHigh = m >> 32, nLow = uint64_t(uint(n)), nHigh = n >> 32;
  const uint64_t low = mLow * nLow;
  const uint64_t cross = mHigh * nLow + (low >> 32);
  const uint64_t otherCross = mLow * nHigh + uint64_t(uint(cross));
  const uint64_t high = mHigh * nHigh + (cross >> 32) + (otherCross >> 32);
  if (high == 0ul) return sign;
  const uint64_t rest = uint64_t(uint((uint(low) | uint(otherCross)) != 0u));
  return packDouble(sign, exponentBits(a) + exponentBits(b) - 2 * kDoubleBias + 1, high | rest);
}

const int kDigit = 19;  // Bits by which each step of a division lengthens the quotient; floats are more accurate.

// Returns 2^(kDigit - 24) / the mantissa of b, within some 4 units in the last place.
float inverseMantissa(Double b) {
  return float(1 << kDigit) / float(int(mantissaOf(b) >> 24));
}

Double quotientBy(Double a, Double b, float inverse) {
  const uint64_t sign = (a ^ b) & kDoubleSign;
  const uint64_t divisor = mantissaOf(b);
  uint64_t rest = mantissaOf(a), digits = 0ul;  // The rest may be negative, in two's complement.
  if (rest == 0ul) return sign;
  for (int step = 0; step < 3; ++step) {
    // A digit may be one too large or too small; the next one makes up for it.
    const int digit = int(floor(float(int(int64_t(rest) >> 24)) * inverse + 0.5f));
    rest = (rest << kDigit) - uint64_t(int64_t(digit)) * divisor;
    digits = (digits << kDigit) + uint64_t(int64_t(digit));
  }
  if (int64_t(rest) < 0l) {
    rest += divisor;
    --digits;
  }
  const uint64_t mantissa = (digits << 4) | uint64_t(uint(rest != 0ul));
  return packDouble(sign, exponentBits(a) - exponentBits(b) + 62 - 3 * kDigit - 4, mantissa);
}

// `b` must not be 0.
Double quotient(Double a, Double b) {
  return quotientBy(a, b, inverseMantissa(b));
}

// Returns an integer with the same order as doubles: 0 if and only if a is 0.
int64_t orderOf(Double a) {
  const int64_t size = int64_t(absolute(a));
  return (a & kDoubleSign) != 0ul ? -size : size;
}

Double minimum(Double a, Double b) {
  return orderOf(b) < orderOf(a) ? b : a;
}

Double maximum(Double a, Double b) {
  return orderOf(a) < orderOf(b) ? b : a;
}

// Return the integer; beyond 2^30, an integer beyond 2^30.
int floorOf(Double a) {
  const int shift = 52 - min(exponentBits(a) - kDoubleBias, 30);
  const uint64_t mantissa = mantissaOf(a);
  const int whole = shift > 52 ? 0 : min(int(uint(mantissa >> shift)), 0x7ffffffe);  // Its negative must exist.
  const bool isWhole = shift > 52 ? mantissa == 0ul : (mantissa & ((1ul << shift) - 1ul)) == 0ul;
  return (a & kDoubleSign) != 0ul ? -whole - int(!isWhole) : whole;
}

int ceilOf(Double a) {
  return -floorOf(negative(a));
}
