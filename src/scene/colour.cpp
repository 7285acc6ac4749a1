#include "scene/colour.h"

#include <raymap/error.h>

#include <algorithm>
#include <string>

namespace raymap {

void checkPictureSize(int width, int height) {
  const auto isValid = [](int side) { return side >= 1 && side <= kMaxPictureSide; };
  if (!isValid(width) || !isValid(height))
    throw Error(ErrorCode::Usage, "a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                                      " pixels cannot be made: both sides must be 1 to " +
                                      std::to_string(kMaxPictureSide));
}

Picture makePicture(int width, int height) {
  checkPictureSize(width, height);
  return {width, height, std::vector<uint8_t>(3 * size_t(width) * size_t(height))};
}

double roundedUp(double length) {
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (length <= factor * power * (1.0 + 1e-9)) return factor * power;
  return 10.0 * power;
}

Colour distanceColour(double value, double range) {
  const Colour* ramp = value < 0.0 ? kInside : kOutside;
  const double depth = range > 0.0 ? std::min(std::abs(value) / range, 1.0) : 0.0;
  return depth < 0.5 ? glm::mix(ramp[0], ramp[1], 2.0 * depth)
                     : glm::mix(ramp[1], ramp[2], 2.0 * depth - 1.0);
}

Colour drawContour(const Colour& ground, double value, double slope, const Colour& line) {
  return glm::mix(ground, line, lineCoverage(std::abs(value) / slope, 2.8));
}

Colour drawIsoLines(const Colour& ground, double value, double slope, double step) {
  // Lines fade out where they are closer than a few pixels: they would merge into grey.
  const double strength = 0.45 * std::clamp(step / slope / 3.0 - 1.0, 0.0, 1.0);
  const double toLine = std::abs(value - step * std::round(value / step)) / slope;
  return ground * (1.0 - strength * lineCoverage(toLine, 1.2));
}

}  // namespace raymap
