const float kPi = 3.14159265358979;

// Devices may compute the arc tangent with an error of 4096 units in the last place.
float arcTangent(float y, float x) {
  const float low = min(abs(x), abs(y)), high = max(abs(x), abs(y));
  if (high == 0) return 0;
  const float z = low / high, z2 = z * z;
  float angle = z * (0.99999934 + z2 * (-0.33329861 + z2 * (0.19946566 + z2 * (-0.1390863 + z2 * (0.096421974 +
                z2 * (-0.055912327 + z2 * (0.021862958 - z2 * 0.004054567)))))));
  if (abs(y) > abs(x)) angle = 0.5 * kPi - angle;
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
}
