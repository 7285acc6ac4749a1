#pragma once

#include <raymap/picture.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace raymap {

/// Linear light, 0 to 1. Pictures hold it sRGB-encoded.
using Colour = glm::dvec3;

inline double encodeSrgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

/// Returns a colour from sRGB components, 0 to 255.
inline Colour srgb(int red, int green, int blue) {
  const auto decode = [](int value) {
    const double s = value / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  return {decode(red), decode(green), decode(blue)};
}

inline void setPixel(Picture& picture, int x, int y, const Colour& colour) {
  uint8_t* pixel = picture.rgb.data() + 3 * (size_t(y) * size_t(picture.width) + size_t(x));
  for (int c = 0; c < 3; ++c)
    pixel[c] = static_cast<uint8_t>(std::lround(255.0 * encodeSrgb(std::clamp(colour[c], 0.0, 1.0))));
}

/// Throws `Error(Usage)` unless both sides are 1 to `kMaxPictureSide`.
void checkPictureSize(int width, int height);
/// Returns a black picture. Throws as `checkPictureSize` does.
Picture makePicture(int width, int height);

/// Returns the least number that is at least `length` and 1, 2 or 5 times a power of ten.
double roundedUp(double length);

/// Returns the share of a pixel that a line covers. The line is `width` pixels wide, its middle `distance`
/// pixels away.
inline double lineCoverage(double distance, double width) {
  return std::clamp(0.5 * width + 0.5 - distance, 0.0, 1.0);
}

/// Colours at the surface, half way and deepest.
inline const Colour kOutside[] = {srgb(255, 246, 232), srgb(247, 190, 120), srgb(206, 104, 52)};
inline const Colour kInside[] = {srgb(228, 241, 250), srgb(116, 173, 214), srgb(38, 84, 148)};

/// Returns the colour of a slice where the distance is `value`: warm outside, cool inside, palest at zero and
/// deepest at +-`range`.
Colour distanceColour(double value, double range);

/// Returns the colour of a winding number. Where |w| > 0.5 it is inside: cool, or green where w < 0, and
/// deeper with each further turn. Outside is warm. Both are palest at the threshold.
Colour windingColour(double value);

/// Returns the colour of a confidence: dark at 0, teal at 0.5, pale at 1.
Colour confidenceColour(double value);

/// Returns a colour for a triangle; triangles of neighbouring indices differ. `kNoTriangle` is light grey.
Colour triangleColour(uint32_t triangle);

inline const Colour kNotFinite = srgb(140, 60, 160);
inline const Colour kContour = srgb(24, 26, 32);

/// Draws a thick line over `ground` where the value is zero; `slope` as below.
Colour drawContour(const Colour& ground, double value, double slope, const Colour& line);

/// Draws lines over `ground` at multiples of `step`. `slope` is the change of the value across a pixel.
Colour drawIsoLines(const Colour& ground, double value, double slope, double step);

}  // namespace raymap
