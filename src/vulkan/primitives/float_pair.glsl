// Numbers as sums of two floats, the second one at most half a unit in the last place of the first: about 48 bits
// (Dekker 1971, Knuth 1969). Every operation must be rounded by itself, hence `precise`. Operands and results must lie
// between 1e-12 and 1e12 or be 0; below, bits of the second float may get lost.

struct FloatPair {
  float high;
  float low;
};

FloatPair pairOf(float a) {
  FloatPair pair;
  pair.high = a;
  pair.low = 0.0f;
  return pair;
}

// Returns a + b exactly.
FloatPair exactSum(float a, float b) {
  precise const float total = a + b;
  precise const float taken = total - a;
  precise const float rest = (a - (total - taken)) + (b - taken);
  FloatPair pair;
  pair.high = total;
  pair.low = rest;
  return pair;
}

// Does the same where |a| >= |b|.
FloatPair renormalized(float a, float b) {
  precise const float total = a + b;
  precise const float rest = b - (total - a);
  FloatPair pair;
  pair.high = total;
  pair.low = rest;
  return pair;
}

// Returns a * b exactly.
FloatPair exactProduct(float a, float b) {
  precise const float aScaled = a * 4097.0f, bScaled = b * 4097.0f;
  precise const float aHigh = aScaled - (aScaled - a), bHigh = bScaled - (bScaled - b);
  precise const float aLow = a - aHigh, bLow = b - bHigh;
  precise const float total = a * b;
  precise const float rest = ((aHigh * bHigh - total) + aHigh * bLow + aLow * bHigh) + aLow * bLow;
  FloatPair pair;
  pair.high = total;
  pair.low = rest;
  return pair;
}

FloatPair pairSum(FloatPair a, FloatPair b) {
  const FloatPair high = exactSum(a.high, b.high), low = exactSum(a.low, b.low);
  precise const float carry = high.low + low.high;
  const FloatPair partial = renormalized(high.high, carry);
  precise const float rest = partial.low + low.low;
  return renormalized(partial.high, rest);
}

FloatPair pairNegative(FloatPair a) {
  FloatPair pair;
  pair.high = -a.high;
  pair.low = -a.low;
  return pair;
}

FloatPair pairProduct(FloatPair a, FloatPair b) {
  const FloatPair high = exactProduct(a.high, b.high);
  precise const float rest = high.low + (a.high * b.low + a.low * b.high);
  return renormalized(high.high, rest);
}

// Returns a divided by b, which must not be 0, however the device rounds quotients of floats.
FloatPair pairQuotient(FloatPair a, FloatPair b) {
  const FloatPair first = pairOf(a.high / b.high);
  const FloatPair rest = pairSum(a, pairNegative(pairProduct(first, b)));
  const FloatPair second = pairOf(rest.high / b.high);
  const FloatPair last = pairSum(rest, pairNegative(pairProduct(second, b)));
  return pairSum(pairSum(first, second), pairOf(last.high / b.high));
}

// Returns the root of a number that is not negative, from one that is a few units in the last place off.
FloatPair pairRoot(FloatPair a) {
  if (!(a.high > 0.0f)) return pairOf(0.0f);
  const FloatPair first = pairOf(sqrt(a.high));
  const FloatPair rest = pairSum(a, pairNegative(pairProduct(first, first)));
  const FloatPair second = pairSum(first, pairOf(rest.high / (2.0f * first.high)));
  const FloatPair left = pairSum(a, pairNegative(pairProduct(second, second)));
  return pairSum(second, pairOf(left.high / (2.0f * first.high)));
}
