#pragma once

#include <raymap/picture.h>

#include <algorithm>
#include <cstdlib>
#include <glm/glm.hpp>
#include <vector>

namespace raymap {

inline glm::ivec3 pixelAt(const Picture& picture, int x, int y) {
  const uint8_t* rgb = picture.rgb.data() + 3 * (size_t(y) * size_t(picture.width) + size_t(x));
  return {rgb[0], rgb[1], rgb[2]};
}

/// Returns the largest difference of the colours of two pixels.
inline int colourGap(const glm::ivec3& a, const glm::ivec3& b) {
  const glm::ivec3 gap = glm::abs(a - b);
  return std::max({gap.x, gap.y, gap.z});
}

/// Returns the mean difference of the bytes of two pictures of one size.
inline double meanDifference(const Picture& a, const Picture& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(a.rgb[i] - b.rgb[i]);
  return sum / double(a.rgb.size());
}

/// Returns the picture of pixels that a device drew.
inline Picture pictureOf(const std::vector<uint32_t>& pixels, int width, int height) {
  Picture picture{width, height, {}};
  for (const uint32_t pixel : pixels)
    for (const int shift : {0, 8, 16}) picture.rgb.push_back(uint8_t(pixel >> shift));
  return picture;
}

}  // namespace raymap
