// Returns sum / 6, correctly rounded, which GLSL's division does not guarantee. Holds for |sum| < 2^24: 4 and
// 2 times the estimate are within a factor of two of their minuends, so the remainder is exact. No quotient
// is so close to the middle between two floats that the last rounding could go wrong.
float sixth(int sum) {
  const float kSixth = 1.0 / 6.0;
  const float estimate = float(sum) * kSixth;
  precise const float remainder = (float(sum) - 4.0 * estimate) - 2.0 * estimate;
  precise const float result = estimate + remainder * kSixth;
  return result;
}
