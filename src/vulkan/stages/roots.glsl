// Square roots for bounds. Vulkan lets devices err by 2 units in the last place in inversesqrt, and by about 5 in sqrt.

// Units in the last place by which tests let inversesqrt and sqrt err more than this device does.
layout(constant_id = 2) const int kRootError = 0;

// Share by which bounds move outwards. This is more than what devices err by in roots and in the few operations around
// them: 33 roundings to floats.
const float kOutwards = 2e-6;

float inverseRoot(float x) {
  return intBitsToFloat(floatBitsToInt(inversesqrt(x)) + kRootError);
}

float root(float x) {
  return x > 0 ? intBitsToFloat(floatBitsToInt(sqrt(x)) + kRootError) : 0;
}

// Returns the length of the part of `q` across a unit vector, `height` being the part along it. Where the squares
// nearly cancel, the result is too large rather than too small.
float lengthAcross(vec3 q, float height) {
  return root((1 + kOutwards) * dot(q, q) - height * height);
}
