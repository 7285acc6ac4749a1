#include "picture/colour.h"

#include <raymap/error.h>
#include <raymap/field.h>

#include <algorithm>
#include <string>

#include "picture/shade_shared.h"

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

Colour windingColour(double value) {
  static const Colour kTurned[] = {srgb(230, 245, 226), srgb(122, 190, 124), srgb(34, 108, 66)};
  static const Colour kDeepest[] = {srgb(16, 30, 66), srgb(12, 44, 30)};
  const double beyond = std::abs(value) - 0.5;
  if (beyond <= 0.0) return glm::mix(kOutside[0], kOutside[1], -2.0 * beyond);
  const Colour* ramp = value < 0.0 ? kTurned : kInside;
  if (beyond < 0.5) return glm::mix(ramp[0], ramp[1], 2.0 * beyond);
  if (beyond < 1.5) return glm::mix(ramp[1], ramp[2], beyond - 0.5);
  return glm::mix(ramp[2], kDeepest[value < 0.0 ? 1 : 0], std::min(beyond - 1.5, 1.0));
}

Colour confidenceColour(double value) {
  static const Colour kRamp[] = {srgb(34, 30, 40), srgb(36, 136, 128), srgb(240, 247, 214)};
  const double share = std::clamp(value, 0.0, 1.0);
  return share < 0.5 ? glm::mix(kRamp[0], kRamp[1], 2.0 * share)
                     : glm::mix(kRamp[1], kRamp[2], 2.0 * share - 1.0);
}

Colour triangleColour(uint32_t triangle) {
  if (triangle == kNoTriangle) return srgb(238, 239, 241);
  uint32_t hash = (triangle ^ triangle >> 16) * 0x7feb352du;  // Mixes all bits (Wellons 2018).
  hash = (hash ^ hash >> 15) * 0x846ca68bu;
  hash ^= hash >> 16;
  const double hue = 6.0 * double(hash & 0xffff) / 65536.0;
  const double value = 120.0 + double(hash >> 16 & 0x7f), paleness = 0.15 + 0.4 * double(hash >> 24) / 255.0;
  const auto part = [&](double centre) {
    const double away = std::abs(hue - centre), turn = std::min(away, 6.0 - away);
    return int(value * glm::mix(paleness, 1.0, std::clamp(2.0 - turn, 0.0, 1.0)));
  };
  return srgb(part(0.0), part(2.0), part(4.0));
}

Colour drawContour(const Colour& ground, double value, double slope, const Colour& line) {
  return glm::mix(ground, line, lineCoverage(std::abs(value) / slope, kContourWidth));
}

Colour drawIsoLines(const Colour& ground, double value, double slope, double step) {
  // Lines fade out where they are closer than a few pixels: they would merge into grey.
  const double strength = kIsoLineStrength * std::clamp(step / slope / kIsoLinePixels - 1.0, 0.0, 1.0);
  const double toLine = std::abs(value - step * std::round(value / step)) / slope;
  return ground * (1.0 - strength * lineCoverage(toLine, kIsoLineWidth));
}

}  // namespace raymap
