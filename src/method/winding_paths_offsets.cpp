#include "method/winding_paths_offsets.h"

#include <cmath>

namespace raymap {

namespace {

// Sides of the box of built-in offset points, as a share of the grid's sides. A longer path crosses more
// broken surface; if all paths are short, they all see the same. docs/signs.md has figures for other sizes.
constexpr double kBox = 3.0 / 16.0;

/// Returns the built-in offset point of a pass. The points are an additive low-discrepancy sequence (Roberts
/// 2018) over a box around the sample, so that any number of passes is well spaced.
glm::ivec3 builtInOffset(int64_t pass, const glm::ivec3& dims) {
  constexpr double kRoot = 1.2207440846057596;  // x^4 = x + 1
  const double steps[3] = {1.0 / kRoot, 1.0 / (kRoot * kRoot), 1.0 / (kRoot * kRoot * kRoot)};
  glm::ivec3 offset;
  for (int c = 0; c < 3; ++c) {
    const double turn = 0.5 + double(pass + 1) * steps[c];
    offset[c] = static_cast<int>(std::lround((turn - std::floor(turn) - 0.5) * kBox * dims[c]));
  }
  return offset;
}

}  // namespace

glm::ivec3 offsetOf(const Options& options, int64_t pass, const glm::ivec3& dims) {
  if (options.offsets.empty()) return builtInOffset(pass, dims);
  // With an offset of `dims` the point lies outside for every sample; a larger offset changes nothing.
  return glm::clamp(options.offsets[size_t(pass) % options.offsets.size()], -dims, dims);
}

}  // namespace raymap
