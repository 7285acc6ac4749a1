#pragma once

#include <gtest/gtest.h>
#include <raymap/render.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <glm/glm.hpp>

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

/// Checks that pictures of a device and of the CPU are as close as render.h promises.
inline void expectClose(const Picture& ours, const Picture& theirs) {
  ASSERT_EQ(ours.rgb.size(), theirs.rgb.size());
  const size_t pixels = ours.rgb.size() / 3;
  std::array<double, 3> sum{};
  size_t off = 0;
  for (size_t p = 0; p < pixels; ++p) {
    int worst = 0;
    for (size_t c = 0; c < 3; ++c) {
      const int difference = std::abs(int(ours.rgb[3 * p + c]) - int(theirs.rgb[3 * p + c]));
      sum[c] += difference;
      worst = std::max(worst, difference);
    }
    off += worst > 8 ? 1 : 0;
  }
  for (const double s : sum) EXPECT_LE(s / double(pixels), 0.1);
  EXPECT_LE(double(off) / double(pixels), 0.002);
}

}  // namespace raymap
