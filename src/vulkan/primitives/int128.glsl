// 128-bit integers in two's complement.

struct Int128 {
  uint64_t low;
  int64_t high;
};

Int128 sum(Int128 a, Int128 b) {
  const uint64_t low = a.low + b.low;
  return Int128(low, a.high + b.high + int64_t(low < a.low));
}

Int128 negative(Int128 a) {
  return Int128(~a.low + 1, ~a.high + int64_t(a.low == 0));
}

bool isPositive(Int128 a) {
  return a.high > 0 || (a.high == 0 && a.low != 0);
}

Int128 unsignedProduct(uint64_t a, uint64_t b) {
  const uint64_t mask = 0xFFFFFFFFul;
  const uint64_t low = (a & mask) * (b & mask);
  const uint64_t cross = (a >> 32) * (b & mask), otherCross = (a & mask) * (b >> 32);
  const uint64_t middle = (low >> 32) + (cross & mask) + (otherCross & mask);
  const uint64_t high = (a >> 32) * (b >> 32) + (cross >> 32) + (otherCross >> 32) + (middle >> 32);
  return Int128((middle << 32) | (low & mask), int64_t(high));
}

Int128 longProduct(int64_t a, int64_t b) {
  Int128 result = unsignedProduct(uint64_t(a), uint64_t(b));
  if (a < 0) result.high -= b;
  if (b < 0) result.high -= a;
  return result;
}

// Returns the product modulo 2^128.
Int128 longProduct(Int128 a, int64_t b) {
  Int128 result = unsignedProduct(a.low, uint64_t(b));
  if (b < 0) result.high -= int64_t(a.low);
  result.high += a.high * b;
  return result;
}
