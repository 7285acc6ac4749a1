// The frame of a triangle, in pairs of floats: with floats alone, slivers would lie far from their corners. Vectors are
// scaled to the longest edge, so that no product gets too small or too large.

#include "vulkan/primitives/float_pair.glsl"

struct PairVector {
  FloatPair x, y, z;
};

PairVector differenceOf(vec3 a, vec3 b, float scale) {
  const FloatPair x = exactSum(a.x, -b.x), y = exactSum(a.y, -b.y), z = exactSum(a.z, -b.z);
  return PairVector(FloatPair(scale * x.high, scale * x.low), FloatPair(scale * y.high, scale * y.low),
                    FloatPair(scale * z.high, scale * z.low));
}

FloatPair dotOf(PairVector a, PairVector b) {
  return pairSum(pairSum(pairProduct(a.x, b.x), pairProduct(a.y, b.y)), pairProduct(a.z, b.z));
}

PairVector timesOf(PairVector a, FloatPair s) {
  return PairVector(pairProduct(a.x, s), pairProduct(a.y, s), pairProduct(a.z, s));
}

// Returns a - s * b.
PairVector minusTimes(PairVector a, FloatPair s, PairVector b) {
  const PairVector taken = timesOf(b, pairNegative(s));
  return PairVector(pairSum(a.x, taken.x), pairSum(a.y, taken.y), pairSum(a.z, taken.z));
}

// `a` must not be 0.
PairVector unitOf(PairVector a) {
  return timesOf(a, pairQuotient(pairOf(1.0), pairRoot(dotOf(a, a))));
}

vec3 roundedOf(PairVector a) {
  return vec3(a.x.high, a.y.high, a.z.high);
}

// Returns a unit vector perpendicular to the unit vector `x`, in the plane of `x` and `e` if that is one. `across`, the
// part of `e` perpendicular to `x`, may be mostly rounding error; then `e` lies along `x`, and any direction
// perpendicular to `x` will do.
PairVector directionAcross(PairVector x, PairVector across) {
  if (!(dotOf(across, across).high > 1e-22)) {
    const vec3 other = abs(x.x.high) < 0.6 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    across = differenceOf(other, vec3(0), 1.0);
  }
  // The second round takes what rounding has left along x.
  [[dont_unroll]] for (uint round = 0; round < 2; ++round) across = unitOf(minusTimes(across, dotOf(across, x), x));
  return across;
}

float inverseOf(FloatPair square, float scale) {
  return square.high > 1e-24 ? scale * scale / square.high : 0.0;
}

// Returns a power of two that brings a positive length to between 1 and 2, if it is not too small for that.
float scaleFor(float length) {
  const uint exponent = clamp(floatBitsToUint(length) >> 23, 107u, 187u);
  return uintBitsToFloat((254u - exponent) << 23);
}

float largestOf(vec3 v) {
  return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

// The longest edge becomes ab, so that c lies over it and slivers keep a sound frame.
Triangle makeFrame(vec3 p, vec3 q, vec3 r) {
  const float scale = scaleFor(max(max(largestOf(q - p), largestOf(r - q)), largestOf(p - r)));
  const vec3 pq = scale * (q - p), qr = scale * (r - q), rp = scale * (p - r);
  const float pq2 = dot(pq, pq), qr2 = dot(qr, qr), rp2 = dot(rp, rp);
  const bool fromQ = qr2 >= pq2 && qr2 >= rp2, fromR = !fromQ && rp2 > pq2;
  const vec3 a = fromQ ? q : fromR ? r : p, b = fromQ ? r : fromR ? p : q, c = fromQ ? p : fromR ? q : r;
  const PairVector ab = differenceOf(b, a, scale), e = differenceOf(c, a, scale);
  const FloatPair bx = pairRoot(dotOf(ab, ab));
  PairVector x = differenceOf(vec3(1, 0, 0), vec3(0), 1.0);
  if (bx.high > 0.0) x = timesOf(ab, pairQuotient(pairOf(1.0), bx));
  const FloatPair cx = dotOf(e, x);
  const PairVector across = minusTimes(e, cx, x), y = directionAcross(x, across);
  const FloatPair cy = dotOf(across, y), beyond = pairSum(cx, pairNegative(bx)), cy2 = pairProduct(cy, cy);
  const float unit = 1.0 / scale;
  return Triangle(a, roundedOf(x), roundedOf(y), cross(roundedOf(x), roundedOf(y)), unit * bx.high,
                  unit * clamp(cx.high, 0.0, bx.high), unit * max(cy.high, 0.0),
                  inverseOf(pairSum(pairProduct(beyond, beyond), cy2), scale),
                  inverseOf(pairSum(pairProduct(cx, cx), cy2), scale));
}
