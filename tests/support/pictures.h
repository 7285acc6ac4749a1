#pragma once

#include <gtest/gtest.h>
#include <raymap/render.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace raymap {

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
